// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace nodmap::slam6d {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Of a vector v: skew(v) * w = v x w.
[[nodiscard]] inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

/// A covariance or information of position (m) and rotation vector (rad) in the axes that `R` turns
/// its own into.
[[nodiscard]] inline Matrix6d rotated(const Matrix6d& matrix, const Eigen::Matrix3d& R) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = R;
  turn.bottomRightCorner<3, 3>() = R;
  return turn * matrix * turn.transpose();
}

/// How a small motion of a body about one of its points moves the point at the end of a moment arm.
[[nodiscard]] inline Matrix6d moment_arm_jacobian(const Eigen::Vector3d& moment_arm) {
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -skew(moment_arm);
  return J;
}

}  // namespace nodmap::slam6d
