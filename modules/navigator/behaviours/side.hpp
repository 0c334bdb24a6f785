// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

namespace nodmap::navigator {

/// A side of the robot: to which it rotates, or on which it passes an obstacle.
enum class Side : std::int8_t { kRight = -1, kNone = 0, kLeft = 1 };

/// The sign of angles to this side: +1 left, -1 right.
[[nodiscard]] constexpr double sign(Side side) {
  return static_cast<double>(side);
}

/// The side of an angle, or of a yaw rate.
[[nodiscard]] inline Side side_of(double angle_rad) {
  return std::signbit(angle_rad) ? Side::kRight : Side::kLeft;
}

[[nodiscard]] constexpr Side opposite(Side side) {
  return static_cast<Side>(-static_cast<std::int8_t>(side));
}

}  // namespace nodmap::navigator
