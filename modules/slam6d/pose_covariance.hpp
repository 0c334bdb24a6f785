// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/registration/dense_solvers.hpp"

namespace nodmap::slam6d {

using registration::Matrix6d;
using registration::Vector6d;

/// The matrix with skew(v) * w = v x w.
[[nodiscard]] inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

/// A covariance or information matrix of position (m) and rotation vector (rad), rotated from its
/// own axes into others by `R`.
[[nodiscard]] inline Matrix6d rotated(const Matrix6d& matrix, const Eigen::Matrix3d& R) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = R;
  turn.bottomRightCorner<3, 3>() = R;
  return turn * matrix * turn.transpose();
}

/// The Jacobian of the motion of a point at the end of a moment arm, with respect to a small motion
/// of the body (position in m, rotation vector in rad) at the arm's beginning.
[[nodiscard]] inline Matrix6d moment_arm_jacobian(const Eigen::Vector3d& moment_arm) {
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -skew(moment_arm);
  return J;
}

}  // namespace nodmap::slam6d
