// SPDX-License-Identifier: BSD-3-Clause
// For tests: poses, moved a little.
#pragma once

#include "common/geometry/se3.hpp"
#include "common/registration/pose_graph.hpp"

namespace nodmap::registration::test {

/// The pose, moved about its own position: x, y in m and yaw in rad, or position (m) and rotation
/// vector (rad), in the axes of map.
[[nodiscard]] inline geometry::SE2 moved(const geometry::SE2& T,
                                         const PoseVector<geometry::SE2>& motion) {
  return {T.x + motion[0], T.y + motion[1], T.yaw + motion[2]};
}
[[nodiscard]] inline geometry::SE3 moved(const geometry::SE3& T,
                                         const PoseVector<geometry::SE3>& motion) {
  geometry::SE3 result = T;
  result.translation() += motion.head<3>();
  result.linear() = geometry::rotation_of(motion.tail<3>()) * T.linear();
  return result;
}

}  // namespace nodmap::registration::test
