// SPDX-License-Identifier: BSD-3-Clause
// The errors of a point cloud, compared with the true surfaces.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/geometry/se3.hpp"
#include "sim/world/world.hpp"

namespace nodmap::evaluate {

/// A point farther than this from every surface is an outlier; a surface farther than this from
/// every point is missing.
inline constexpr double kOutlierM = 0.10;

struct CloudErrors {
  std::size_t n = 0;
  double rms_m = 0.0;  ///< of all points, including outliers
  double p95_m = 0.0;
  double outlier_share = 0.0;  ///< of points farther than kOutlierM from the nearest surface
  /// Fraction of the objects' surfaces with a point nearer than kOutlierM. Backs and undersides
  /// count, so 1 cannot be reached; use it to compare runs in one world.
  double completeness = 0.0;
};

/// How completely moving points were removed from a cloud, and static points kept (Zhang et al., A
/// Dynamic Points Removal Benchmark in Point Cloud Maps, 2023). A point farther than kOutlierM from
/// every surface of the world counts as moving.
struct RemovalErrors {
  double static_kept = 1.0;      ///< share of the static points that were kept (SA)
  double dynamic_removed = 1.0;  ///< share of the moving points that were removed (DA)
  double associated = 1.0;       ///< geometric mean of both (AA)
};

/// Computed from the errors of the cloud before and after the removal.
[[nodiscard]] RemovalErrors measure_removal(const CloudErrors& before, const CloudErrors& after);

/// Measures a cloud, registered in map; all zero for an empty one.
[[nodiscard]] CloudErrors measure_cloud(const std::vector<Eigen::Vector3f>& cloud_map,
                                        const geometry::SE3& T_world_map, const sim::World& world);

}  // namespace nodmap::evaluate
