// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bench/live/robot_processes.hpp"

namespace nodmap::bench {

/// Attacks the robot while it drives, each attack for `duration_s` and on a freshly started robot.
/// Prints a table of the collisions, of how the robot stopped or drove on, and of the processes
/// that reported the attack in STATUS. Runs only the attacks with `only` in their name. Returns the
/// exit code, which is 0 if everything was as SAFETY.md promises. Run it in a private network
/// (tests/support/private_network.sh), whose user may forge source addresses.
[[nodiscard]] int run_attacks(RobotProcesses::Options options, const std::string& only,
                              double duration_s);

}  // namespace nodmap::bench
