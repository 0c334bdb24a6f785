// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Thrown for a name of no world; what() is one line.
class WorldNameError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Makes the world for a file, "SCENARIO:SEED" such as "random:1" or "holes:7", "barn:FILE:INDEX",
/// or "pedestrians:FILE:FRAMES_PER_SECOND:SEED". Throws std::runtime_error.
[[nodiscard]] World make_world(const std::string& name);

}  // namespace nodmap::sim
