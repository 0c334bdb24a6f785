// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace nodmap::slam2d {

/// What pairs with a known surface normal say about the pose (x, y, yaw): the least-squares problem
/// of Eq. 3 with distances counted across the surface only, linearised at the present pose, and how
/// well it determines each direction.
class NormalEquations {
 public:
  /// The directions the pairs leave open, as a projector. Rotation is scaled to metres by the
  /// pairs' typical lever arm.
  struct Observability {
    Eigen::Matrix3d observable = Eigen::Matrix3d::Identity();  ///< keeps what the pairs determine
    int weak_directions = 0;
  };

  /// One pair: `error_m` along the unit `normal`; `lever` leads from the robot to the point.
  void add(const Eigen::Vector2d& normal, const Eigen::Vector2d& lever, double error_m,
           double weight);

  /// A direction is weak when the information on it is below `weak_share` of what as many pairs
  /// facing it squarely would give. In a corridor that is the direction along its axis.
  [[nodiscard]] Observability observability(double weak_share) const;

  /// What the pairs say on (x, y in m, yaw in rad), without the weak directions: the sum of
  /// w J^T J. Times the inverse variance of a distance it is the inverse covariance of the pose.
  [[nodiscard]] Eigen::Matrix3d information(double weak_share) const;

  /// The step (dx, dy in metres, dyaw in radians) to the minimum within the observable directions.
  [[nodiscard]] Eigen::Vector3d step(double weak_share) const;

 private:
  struct Eigensystem;
  [[nodiscard]] Eigensystem decompose() const;

  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient_ = Eigen::Vector3d::Zero();
  double weight_ = 0.0;
};

}  // namespace nodmap::slam2d
