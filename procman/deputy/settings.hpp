// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "procman/config/config.hpp"

namespace nodmap::procman {

struct DeputySettings {
  std::string id;
  std::string lcm_url;
  /// Which exec lines may be run. Orders alone do not suffice, because LCM does not authenticate
  /// senders.
  std::function<bool(const std::string& exec)> may_run;
  std::string refusal;         ///< message for the sheriff when an exec line is refused
  bool trusts_orders = false;  ///< see Supervisor
  /// The file that `may_run` and `resources_of` come from; reloaded when it is edited. Empty: none.
  std::string config_file;
  /// The resources that a command may use; null: the same as the deputy.
  std::function<Resources(const std::string& id)> resources_of;
};

/// Permits the commands that `config` contains for the deputy, with their resources. Returns false
/// if there are none.
bool allow(DeputySettings& settings, const Config& config);

}  // namespace nodmap::procman
