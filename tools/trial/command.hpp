// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "sim/world/world.hpp"
#include "tools/trial/trial.hpp"

namespace nodmap::trial {

/// A command line that cannot be used; what() is one line.
class CommandError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws CommandError, beginning with `source`, for a process that the robot does not have.
void check_process(std::string_view process, const std::string& source);

/// "PROCESS@T+D", seconds. Throws CommandError.
[[nodiscard]] Kill parse_kill(const std::string& text);

/// A file, "SCENARIO:SEED" such as "random:1" or "holes:7", "barn:FILE:INDEX", or
/// "pedestrians:FILE:FRAMES_PER_SECOND:SEED". Throws std::runtime_error.
[[nodiscard]] sim::World make_world(const std::string& name);

}  // namespace nodmap::trial
