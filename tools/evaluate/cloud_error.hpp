// SPDX-License-Identifier: BSD-3-Clause
// How far a cloud is from the surfaces it is an image of.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/geometry/se3.hpp"
#include "sim/world/world.hpp"

namespace nodmap::evaluate {

/// Farther from every surface a point is an outlier, and farther from every point a surface is
/// missing.
inline constexpr double kOutlierM = 0.10;

struct CloudErrors {
  std::size_t n = 0;
  double rms_m = 0.0;  ///< of all points, outliers included
  double p95_m = 0.0;
  double outlier_share = 0.0;  ///< of points farther than kOutlierM from the nearest surface
  /// Share of the objects' surfaces with a point nearer than kOutlierM. Backs and undersides count,
  /// so that 1 is out of reach; good for comparing runs in one world.
  double completeness = 0.0;
};

/// All zero for an empty cloud.
[[nodiscard]] CloudErrors measure_cloud(const std::vector<Eigen::Vector3f>& cloud_map,
                                        const geometry::SE3& T_world_map, const sim::World& world);

}  // namespace nodmap::evaluate
