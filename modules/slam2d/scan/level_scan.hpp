// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"

namespace nodmap::slam2d {

/// A level scan: the data set D of Eq. 3, and the robot's pose by odometry.
struct LevelScan {
  time::Timestamp stamp{};  ///< of the first beam
  /// In the frame in which odometry began: after a restart it continues from where it was.
  geometry::SE2 T_odom_base;
  Eigen::Vector2d sensor_origin_base = Eigen::Vector2d::Zero();
  std::span<const OrientedPoint> points_base;
  /// The longest time since the previous level scan for which no odometry was published.
  double odometry_gap_s = 0.0;
  /// The longest time since then whose motion only odometry has counted: no scan came, or odometry
  /// itself was published, but did not arrive.
  double unseen_s = 0.0;
  bool odometry_has_restarted = false;  ///< since the previous level scan
  bool is_of_nod = false;               ///< from a nodding scanner: one level scan in each sweep

  /// Whether the robot may have moved farther than odometry has counted. Any odometry comes several
  /// times in half a second.
  [[nodiscard]] bool has_odometry_gap() const { return odometry_gap_s > 0.5; }
  /// Whether only odometry tells where the robot is by now. In half a second it drives about as far
  /// as a match from its last motion can be off.
  [[nodiscard]] bool follows_unseen_motion() const { return unseen_s > 0.5; }
  /// Whether there are enough points to determine a pose.
  [[nodiscard]] bool has_enough_points() const { return points_base.size() >= 10; }
  /// Whether there are enough points to search a wide window: fewer would fit somewhere by chance.
  [[nodiscard]] bool has_enough_to_search() const { return points_base.size() >= 30; }
};

}  // namespace nodmap::slam2d
