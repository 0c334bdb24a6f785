// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "common/geometry/se2.hpp"

namespace nodmap::geometry {

/// A pose in space, or equally the transform it stands for: `T_a_b * p_b == p_a`. Metres;
/// x forward, y left, z up.
using SE3 = Eigen::Isometry3d;

[[nodiscard]] SE3 make_se3(const Eigen::Vector3d& translation, const Eigen::Quaterniond& rotation);

/// The planar pose lifted into space: height, roll and pitch are zero.
[[nodiscard]] SE3 to_se3(const SE2& pose);

/// The pose seen from above: x, y and the heading of the forward axis.
[[nodiscard]] SE2 to_se2(const SE3& pose);

/// Turns a vector about the y (left) axis so that positive angles look up, as the scanner's pitch
/// does: the forward axis goes to (cos p, 0, sin p).
[[nodiscard]] Eigen::Matrix3d pitch_rotation(double pitch_up_rad);

/// The pose at `fraction` of the way from `from` (0) to `to` (1): straight line and SLERP. Values
/// outside [0, 1] extrapolate at the same velocity.
[[nodiscard]] SE3 interpolate(const SE3& from, const SE3& to, double fraction);

/// The rotation vector (axis times angle, rad) of a rotation, and back.
[[nodiscard]] Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation);
[[nodiscard]] Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector);

/// The shortest rotation that turns the direction of `from` into that of `to`; neither may be zero.
[[nodiscard]] Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from,
                                                  const Eigen::Vector3d& to);

/// The matrix with skew(v) * w = v x w.
[[nodiscard]] inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

/// The angle of the rotation part, in [0, pi].
[[nodiscard]] double rotation_angle(const SE3& pose);

/// Between the origins of two poses, m.
[[nodiscard]] inline double distance_m(const SE3& a, const SE3& b) {
  return (a.translation() - b.translation()).norm();
}

/// Between the orientations of two poses, in [0, pi].
[[nodiscard]] inline double rotation_rad(const SE3& a, const SE3& b) {
  return rotation_angle(a.inverse() * b);
}

}  // namespace nodmap::geometry
