// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Loads a recorded crowd as actors: two minutes of a recording, and a robot that has to cross it;
/// the seed chooses when and where. The recorded people do not react to the robot. Walls surround
/// the place, so that there is something to map.
///
/// The file contains lines "frame pedestrian x y" (m) with `frames_per_s` frames per second, as
/// those of Pellegrini et al. (ICCV 2009) and Lerner et al. (2007) are mostly passed on; the
/// pedestrian may be written 1 or 1.0. Throws formats::UserError that names file and line, also if
/// a line has more columns, as in the original obsmat.txt.
[[nodiscard]] World load_pedestrians(const std::filesystem::path& file, double frames_per_s,
                                     std::uint64_t seed);

}  // namespace nodmap::sim
