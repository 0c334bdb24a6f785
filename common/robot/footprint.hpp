// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace nodmap::robot {

/// The robot's outline seen from above: a rectangle centred on base, half extents in metres.
struct Footprint {
  double half_length_m = 0.0;
  double half_width_m = 0.0;

  /// The footprint enlarged by these lengths at front and back, and on each side; negative:
  /// reduced.
  [[nodiscard]] Footprint grown(double length_m, double width_m) const {
    return {half_length_m + length_m, half_width_m + width_m};
  }

  /// Whether a point lies inside, not on the border.
  [[nodiscard]] bool contains(const Eigen::Vector2d& p_base) const {
    return std::abs(p_base.x()) < half_length_m && std::abs(p_base.y()) < half_width_m;
  }

  /// Radius of the circle on which the corners move when the robot rotates on the spot.
  [[nodiscard]] double turning_radius_m() const { return std::hypot(half_length_m, half_width_m); }
};

}  // namespace nodmap::robot
