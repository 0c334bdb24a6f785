// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bench/live/robot_processes.hpp"

namespace nodmap::bench {

/// Kills and breaks each part of the robot while it drives, and prints how it stopped and
/// whether it drove on. Only the cases with `only` in their name. Exit code: 0 all as promised.
[[nodiscard]] int run_faults(RobotProcesses::Options options, const std::string& only);

}  // namespace nodmap::bench
