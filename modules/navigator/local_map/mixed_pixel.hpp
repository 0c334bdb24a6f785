// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "common/scan/scan.hpp"

namespace nodmap::navigator {

/// Whether a beam is a mixed pixel: its spot met the edge of something near and what is behind it.
/// Its range is a mean of both, and nothing is where it ends: farther than one neighbouring beam,
/// nearer than the other, and on the surface of neither. Collected from many poses, mixed pixels
/// would close the gap between the end of a wall and the next wall.
///
/// Near the sensor the spot is as wide as two beams. There two mixed pixels are side by side, on a
/// line that leads almost through the sensor.
///
/// Everything else is no mixed pixel: a surface with two beams side by side, or a thin post, which
/// is nearer than both of its neighbours. One thing is mistaken for one until the robot has moved
/// on: what is one beam wide and, seen from here, beside something nearer.
[[nodiscard]] bool is_mixed_pixel(const scan::Scan& scan, std::size_t beam);

}  // namespace nodmap::navigator
