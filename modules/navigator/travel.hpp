// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "common/geometry/angle.hpp"
#include "common/geometry/se2.hpp"

namespace nodmap::navigator {

/// How far the robot has travelled between two poses of odometry, in metres. A rotation of 1 rad
/// counts as 4 m, because it adds as much error to the heading (2 degrees) as 4 m of path do (1
/// degree times the root of the metres).
[[nodiscard]] inline double travel_m(const geometry::SE2& from, const geometry::SE2& to) {
  constexpr double kMetresPerRad = 4.0;
  return (to.translation() - from.translation()).norm() +
         kMetresPerRad * std::abs(geometry::angle_difference(to.yaw, from.yaw));
}

}  // namespace nodmap::navigator
