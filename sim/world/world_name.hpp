// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Makes the world for a file, "SCENARIO:SEED" such as "random:1" or "holes:7", "barn:FILE:INDEX",
/// or "pedestrians:FILE:FRAMES_PER_SECOND:SEED". Throws formats::UserError.
[[nodiscard]] World make_world(const std::string& name);

}  // namespace nodmap::sim
