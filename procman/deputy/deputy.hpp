// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "procman/deputy/settings.hpp"

namespace nodmap::procman {

/// Runs the deputy until SIGINT, SIGTERM, SIGHUP or SIGQUIT. Returns the exit code: 0 after a clean
/// end, 1 if another deputy of this name is running or being started. Throws std::runtime_error.
int run_deputy(const DeputySettings& settings);

}  // namespace nodmap::procman
