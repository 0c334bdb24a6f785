// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bench/live/robot_processes.hpp"

namespace nodmap::bench {

/// Kills or breaks each part of the robot while it drives, and prints how the robot stopped and
/// whether it drove on. Runs only the cases with `only` in their name. Returns the exit code: 0 if
/// everything was as SAFETY.md promises.
[[nodiscard]] int run_faults(RobotProcesses::Options options, const std::string& only);

}  // namespace nodmap::bench
