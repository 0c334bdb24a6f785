// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/back_end/keyframe.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// T_map_base of each of some consecutive keyframes, moved all at once to where the lines that they
/// saw agree best. The first one stays.
///
/// A scan is matched against the past alone. The first ones find few lines, and none far ahead,
/// where one scan hits a wall only every few decimetres; yet the far points tell the heading. Here
/// each scan counts on the lines that any of them saw. Directions that no line determines follow
/// the present steps.
[[nodiscard]] std::vector<geometry::SE2> adjusted_to_lines(std::span<const Keyframe> keyframes,
                                                           const MapParams& map_params);

}  // namespace nodmap::slam2d
