// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "common/scan/scan.hpp"

namespace nodmap::navigator {

/// Whether a beam is a mixed pixel: its spot met the edge of something near and what is behind it,
/// so that its range is a mean of both, and nothing is where it ends. It is farther than one of the
/// neighbouring beams, nearer than the other, and on the surface of neither. From many poses mixed
/// pixels close the gap between the end of a wall and the next wall.
///
/// Near the sensor the spot is as wide as two beams: two mixed pixels are side by side there, on a
/// line that leads almost through the sensor.
///
/// Any other surface has two beams side by side, and a thin post stands nearer than both of its
/// neighbours: neither is a mixed pixel. What is one beam wide and touches, as seen from here,
/// something nearer, is taken for one, until the robot has moved on.
[[nodiscard]] bool is_mixed_pixel(const scan::Scan& scan, std::size_t beam);

}  // namespace nodmap::navigator
