// SPDX-License-Identifier: BSD-3-Clause
// The unknowns of a registration: a small motion of the middle of the sweep about the base's
// position (m, rad; axes of map) and, if the robot moves during the sweep (N = 12), the correction
// of its path and its rotation from there to the last beam. The path turns with the base.
#pragma once

#include <Eigen/Core>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"

namespace nodmap::slam6d {

[[nodiscard]] inline geometry::SE3 moved(const geometry::SE3& T_map_base, const Vector6d& motion) {
  geometry::SE3 result = T_map_base;
  result.translation() += motion.head<3>();
  result.linear() = geometry::rotation_of(motion.tail<3>()) * T_map_base.linear();
  return result;
}

[[nodiscard]] inline Vector6d motion_between(const geometry::SE3& from, const geometry::SE3& to) {
  Vector6d motion;
  motion << to.translation() - from.translation(),
      geometry::rotation_vector(to.linear() * from.linear().transpose());
  return motion;
}

/// How a small rotation of the base moves it at the end of a path that turns with it.
[[nodiscard]] inline Matrix6d by_rotation(const Eigen::Vector3d& path_map) {
  Matrix6d motion = Matrix6d::Zero();
  motion.topRightCorner<3, 3>() = -geometry::skew(path_map);
  return motion;
}

/// Computes the prior from the covariances of the pose at the first beam and of the motion to the
/// last one. `half_path_map`: path of the base from the middle of the sweep to its end.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, N> motion_covariance(const Matrix6d& at_first_beam,
                                                            const Matrix6d& of_motion,
                                                            const Eigen::Vector3d& half_path_map) {
  if constexpr (N == 6) {
    return at_first_beam;
  } else {
    Eigen::Matrix<double, N, N> from_ends = 0.5 * Eigen::Matrix<double, N, N>::Identity();
    from_ends.template topLeftCorner<6, 6>() = Matrix6d::Identity() + by_rotation(half_path_map);
    from_ends.template topRightCorner<6, 6>() = 0.5 * Matrix6d::Identity();
    Eigen::Matrix<double, N, N> ends = Eigen::Matrix<double, N, N>::Zero();
    ends.template topLeftCorner<6, 6>() = at_first_beam;
    ends.template bottomRightCorner<6, 6>() = of_motion;
    return from_ends * ends * from_ends.transpose();
  }
}

/// The covariance of the pose at the last beam.
template <int N>
[[nodiscard]] Matrix6d end_covariance(const Eigen::Matrix<double, N, N>& covariance,
                                      const Eigen::Vector3d& half_path_map) {
  if constexpr (N == 6) {
    return covariance;
  } else {
    Eigen::Matrix<double, 6, N> to_end;
    to_end << Matrix6d::Identity() + by_rotation(half_path_map), Matrix6d::Identity();
    return to_end * covariance * to_end.transpose();
  }
}

}  // namespace nodmap::slam6d
