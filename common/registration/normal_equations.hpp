// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace nodmap::registration {

/// The least-squares problem of Eq. 3 in the plane with point-to-line distances, linearised at the
/// present pose. Detects the degenerate directions of (x, y, yaw), which the correspondences
/// constrain too little, and leaves them out of the solution (solution remapping: Zhang, Kaess,
/// Singh 2016).
class NormalEquations {
 public:
  struct Solution {
    /// The step to the minimum: dx, dy in metres, dyaw in radians; zero along degenerate
    /// directions.
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    /// Projects such a step onto the determined directions.
    Eigen::Matrix3d projector = Eigen::Matrix3d::Identity();
    int degenerate_directions = 0;
    /// The smallest ratio, over all directions, of the information to the information that the same
    /// correspondences would give if all their normals pointed along the direction.
    double least_information_ratio = 0.0;
  };

  /// Adds the correspondence of a point with a line. `normal`: unit normal of the line;
  /// `moment_arm`: from the robot to the point, metres; `distance_m`: of the point from the line,
  /// positive along the normal.
  void add(const Eigen::Vector2d& normal, const Eigen::Vector2d& moment_arm, double distance_m,
           double weight) {
    const double x = normal.x();
    const double y = normal.y();
    const double yaw = moment_arm.x() * y - moment_arm.y() * x;
    sums_.xx += weight * x * x;
    sums_.yx += weight * y * x;
    sums_.yy += weight * y * y;
    sums_.yaw_x += weight * yaw * x;
    sums_.yaw_y += weight * yaw * y;
    sums_.yaw_yaw += weight * yaw * yaw;
    sums_.x += weight * distance_m * x;
    sums_.y += weight * distance_m * y;
    sums_.yaw += weight * distance_m * yaw;
    sums_.weight += weight;
  }

  /// Computes the step. A direction is degenerate when the information about it is below
  /// `min_information_ratio` times what the same correspondences would give if all their normals
  /// pointed along it; in a corridor this is the direction of the corridor's axis. To compare
  /// rotation with translation, yaw is multiplied by the root mean square moment arm.
  [[nodiscard]] Solution solve(double min_information_ratio) const;

  /// The information matrix of (x, y in m, yaw in rad): the sum of w J^T J, without the degenerate
  /// directions of `solution`, which solve() returned. Divided by the variance of a distance it is
  /// the inverse covariance of the pose.
  [[nodiscard]] Eigen::Matrix3d information(const Solution& solution) const;

 private:
  struct Eigensystem;
  [[nodiscard]] Eigensystem decompose() const;

  [[nodiscard]] Eigen::Matrix3d information() const;

  /// Weighted sums over the correspondences. They are separate numbers so that the compiler can
  /// keep them in registers from one add() to the next.
  struct Sums {
    double xx = 0.0;  // of the information matrix
    double yx = 0.0;
    double yy = 0.0;
    double yaw_x = 0.0;
    double yaw_y = 0.0;
    double yaw_yaw = 0.0;
    double x = 0.0;  // of the gradient
    double y = 0.0;
    double yaw = 0.0;
    double weight = 0.0;
  };
  Sums sums_;
};

}  // namespace nodmap::registration
