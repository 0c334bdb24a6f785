// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "common/geometry/angle.hpp"
#include "common/geometry/se2.hpp"

namespace nodmap::navigator {

/// How far the robot has travelled between two poses of odometry, in metres, by what that costs of
/// its accuracy: a rotation of 1 rad costs the heading as much as 4 m of path, 2 degrees against 1
/// degree at 1 m, both growing with the root.
[[nodiscard]] inline double travel_m(const geometry::SE2& from, const geometry::SE2& to) {
  constexpr double kMetresPerRad = 4.0;
  return (to.translation() - from.translation()).norm() +
         kMetresPerRad * std::abs(geometry::angle_difference(to.yaw, from.yaw));
}

}  // namespace nodmap::navigator
