// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace nodmap::map_server {

/// The robot's body seen from above: a rectangle around the base's origin.
struct Footprint {
  double length_m = 0.0;
  double width_m = 0.0;

  /// Whether a place is under the body, and at least `inset_m` from its border.
  [[nodiscard]] bool contains(const Eigen::Vector2d& p_base, double inset_m) const {
    return std::abs(p_base.x()) < 0.5 * length_m - inset_m &&
           std::abs(p_base.y()) < 0.5 * width_m - inset_m;
  }
};

}  // namespace nodmap::map_server
