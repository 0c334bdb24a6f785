// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "procman/config/config.hpp"

namespace nodmap::procman {

struct DeputySettings {
  std::string id;
  std::string lcm_url;
  /// Which exec lines may be run; LCM tells nobody apart, so orders alone do not decide it.
  std::function<bool(const std::string& exec)> may_run;
  std::string refusal;         ///< why not, for who ordered it
  bool trusts_orders = false;  ///< see Supervisor
  /// Where `may_run` and `resources_of` are from; read anew whenever it was edited. Empty: nowhere.
  std::string config_file;
  /// What a command may take of the host; null: as much as the deputy.
  std::function<Resources(const std::string& id)> resources_of;
};

/// Lets run what `config` names for the deputy, with the resources it says. Whether that is
/// anything.
bool allow(DeputySettings& settings, const Config& config);

/// Serves until SIGINT, SIGTERM, SIGHUP or SIGQUIT. Returns the exit code: 0 after a clean end, 1
/// when another deputy of this name is being started, 2 when there is one. Throws
/// std::runtime_error.
int run_deputy(const DeputySettings& settings);

}  // namespace nodmap::procman
