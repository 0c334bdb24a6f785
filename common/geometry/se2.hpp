// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::geometry {

/// A pose in the plane, or equally the transform it stands for: `T_a_b * p_b == p_a`.
/// Metres and radians; x forward, y left, yaw counter-clockwise seen from above.
struct SE2 {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  [[nodiscard]] Eigen::Vector2d translation() const { return {x, y}; }

  [[nodiscard]] Eigen::Matrix2d rotation() const {
    const double c = std::cos(yaw);
    const double s = std::sin(yaw);
    return (Eigen::Matrix2d() << c, -s, s, c).finished();
  }

  [[nodiscard]] SE2 inverse() const {
    const double c = std::cos(yaw);
    const double s = std::sin(yaw);
    return {-c * x - s * y, s * x - c * y, normalize_angle(-yaw)};
  }
};

[[nodiscard]] inline Eigen::Vector2d operator*(const SE2& T_a_b, const Eigen::Vector2d& p_b) {
  const double c = std::cos(T_a_b.yaw);
  const double s = std::sin(T_a_b.yaw);
  return {T_a_b.x + c * p_b.x() - s * p_b.y(), T_a_b.y + s * p_b.x() + c * p_b.y()};
}

[[nodiscard]] inline SE2 operator*(const SE2& T_a_b, const SE2& T_b_c) {
  const Eigen::Vector2d p = T_a_b * T_b_c.translation();
  return {p.x(), p.y(), normalize_angle(T_a_b.yaw + T_b_c.yaw)};
}

/// Between the origins of two poses, m.
[[nodiscard]] inline double distance_m(const SE2& a, const SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// Between the headings of two poses, in [0, pi].
[[nodiscard]] inline double rotation_rad(const SE2& a, const SE2& b) {
  return std::abs(angle_difference(a.yaw, b.yaw));
}

}  // namespace nodmap::geometry
