// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/se2.hpp"
#include "common/geometry/se3.hpp"

namespace nodmap::geometry {

/// How far two poses may be apart.
struct PoseTolerance {
  double distance_m = 0.0;
  double rotation_rad = 0.0;
};

/// Whether two poses are at most this far apart, in position and in orientation.
[[nodiscard]] inline bool is_within(const SE2& a, const SE2& b, const PoseTolerance& tolerance) {
  return (a.translation() - b.translation()).squaredNorm() <=
             tolerance.distance_m * tolerance.distance_m &&
         rotation_rad(a, b) <= tolerance.rotation_rad;
}

[[nodiscard]] inline bool is_within(const SE3& a, const SE3& b, const PoseTolerance& tolerance) {
  return (a.translation() - b.translation()).squaredNorm() <=
             tolerance.distance_m * tolerance.distance_m &&
         rotation_rad(a, b) <= tolerance.rotation_rad;
}

}  // namespace nodmap::geometry
