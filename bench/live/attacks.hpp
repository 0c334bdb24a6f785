// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bench/live/robot_processes.hpp"

namespace nodmap::bench {

/// Attacks the robot while it drives, each attack for `duration_s` and on a robot that was started
/// for it, and prints a table: collisions, how it stopped or drove on, who told of it on STATUS.
/// Only the attacks with `only` in their name. Exit code: 0 all as SAFETY.md promises. To be run
/// in a network of its own (tests/support/private_network.sh), whose user may forge sources.
[[nodiscard]] int run_attacks(RobotProcesses::Options options, const std::string& only,
                              double duration_s);

}  // namespace nodmap::bench
