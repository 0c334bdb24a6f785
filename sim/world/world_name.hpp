// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/formats/user_error.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Thrown for a name of no world; what() is one line.
class WorldNameError : public formats::UserError {
 public:
  using formats::UserError::UserError;
};

/// Makes the world for a file, "SCENARIO:SEED" such as "random:1" or "holes:7", "barn:FILE:INDEX",
/// or "pedestrians:FILE:FRAMES_PER_SECOND:SEED". Throws WorldNameError, or
/// formats::InputFileError for a file that cannot be read or is of another kind.
[[nodiscard]] World make_world(const std::string& name);

}  // namespace nodmap::sim
