// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace nodmap::drawing {

/// A point of a cloud to be drawn, metres in map.
struct DrawnPoint {
  Eigen::Vector3f p_map;
  Eigen::Vector3f normal_map;  ///< of its surface, facing the sensor; zero where none is known
};

/// The interval of heights that contains most points, for colour scales. A few stray points would
/// otherwise take up most of the scale.
struct HeightRange {
  float low_m = 0.0F;
  float high_m = 1.0F;

  /// 0 at the low end, 1 at the high end.
  [[nodiscard]] double place(float height_m) const {
    return static_cast<double>((height_m - low_m) / (high_m - low_m));
  }
};

[[nodiscard]] HeightRange height_range(std::span<const DrawnPoint> points);

}  // namespace nodmap::drawing
