// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "procman/deputy/permissions.hpp"

namespace nodmap::procman {

struct DeputySettings {
  std::string id;
  std::string lcm_url;
  Permissions permissions;
  bool trusts_orders = false;  ///< see Supervisor
  /// The file that the permissions come from; reloaded when it is edited. Empty: none.
  std::string config_file;
};

/// Runs the deputy until SIGINT, SIGTERM, SIGHUP or SIGQUIT. Returns the exit code: 0 after a clean
/// end, 1 if another deputy of this name is running or being started. Throws std::runtime_error.
int run_deputy(const DeputySettings& settings);

}  // namespace nodmap::procman
