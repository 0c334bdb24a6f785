// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/se2.hpp"

namespace nodmap::slam2d {

/// The covariance of base in the map that scans are matched against: of (x, y in m, yaw in rad),
/// position and heading in the axes of map.
///
/// Directions that a match determines take the covariance of that match. Successive matches are not
/// fused, because their errors against one map are correlated. Along degenerate directions, and
/// without a match, the uncertainty grows with the path by odometry.
class PoseCovariance {
 public:
  /// Base moved by odometry. `T_before_now`: the motion; `yaw_rad`: the heading in map before it.
  void predict(double yaw_rad, const geometry::SE2& T_before_now);

  /// The pose was matched. `information`: the inverse covariance in the axes of map, zero along
  /// degenerate directions.
  void update(const Eigen::Matrix3d& information);

  /// Nothing is known of the robot's motion during `duration_s`.
  void lose_track(double duration_s);

  /// The map was rotated, and the robot with it.
  void rotate(double yaw_rad);

  /// The standard deviation of the position, in metres, in the direction in which it is least:
  /// large only if no direction has been matched for long.
  [[nodiscard]] double least_sigma_m() const;

  /// The same in the direction in which it is greatest.
  [[nodiscard]] double greatest_sigma_m() const;

  [[nodiscard]] const Eigen::Matrix3d& matrix() const { return covariance_; }

 private:
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
};

}  // namespace nodmap::slam2d
