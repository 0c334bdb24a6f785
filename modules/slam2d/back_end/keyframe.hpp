// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"
#include "modules/slam2d/scan/view.hpp"

namespace nodmap::slam2d {

/// A scan that was added to the map. It is kept so that its pose can be corrected later, and grids
/// can be drawn from it.
struct Keyframe {
  time::Timestamp stamp{};
  /// In the odom frame of the first keyframe: after a restart, odometry continues from where it
  /// was.
  geometry::SE2 T_odom_base;
  geometry::SE2 T_map_base;
  Eigen::Vector2d sensor_origin_base = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2f> points_base = {};
  std::vector<Eigen::Vector2f> normals_base = {};  ///< of each point; zero where it is not known
};

/// The points of a keyframe with their normals, in base.
[[nodiscard]] std::vector<OrientedPoint> oriented_points(const Keyframe& keyframe);

/// At most about 120 of the points, spread over the scan: enough to match it.
[[nodiscard]] std::vector<OrientedPoint> some_points(const Keyframe& keyframe);

[[nodiscard]] View view_of(const Keyframe& keyframe);

}  // namespace nodmap::slam2d
