// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/se2.hpp"

namespace nodmap::slam2d {

/// How uncertain the pose of base is in the map that scans are matched against: the covariance of
/// (x, y in m, yaw in rad), position and heading of base in the axes of map.
///
/// What a match determines is as certain as that match, not more: the errors of many matches
/// against one map are alike. Along degenerate directions, and where nothing matched, the
/// uncertainty grows with the path by odometry.
class PoseCovariance {
 public:
  /// Base moved by odometry. `T_before_now`: the motion; `yaw_rad`: the heading before, in map.
  void move(double yaw_rad, const geometry::SE2& T_before_now);

  /// The pose was matched. `information`: the inverse covariance in the axes of map, zero along
  /// degenerate directions.
  void match(const Eigen::Matrix3d& information);

  /// Nobody knows how the robot has moved for a while.
  void lose_track(double duration_s);

  [[nodiscard]] const Eigen::Matrix3d& matrix() const { return covariance_; }

 private:
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
};

}  // namespace nodmap::slam2d
