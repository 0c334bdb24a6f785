// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/se2.hpp"

namespace nodmap::slam2d {

/// A measured point of a wall or an object, and which way its surface looks.
struct SurfacePoint {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  /// Unit normal on the side of the scanner; zero where the point stands alone.
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();

  [[nodiscard]] bool has_normal() const { return !normal.isZero(0.0); }
};

[[nodiscard]] inline SurfacePoint operator*(const geometry::SE2& T_a_b, const SurfacePoint& s_b) {
  return {T_a_b * s_b.p, T_a_b.rotation() * s_b.normal};
}

}  // namespace nodmap::slam2d
