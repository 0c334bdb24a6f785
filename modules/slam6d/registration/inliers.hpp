// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/registration/correspondence_search.hpp"

namespace nodmap::slam6d {

/// Points are inliers up to this many scales of the finest voxels' robust kernel from a plane.
inline constexpr double kInlierScales = 2.0;

/// The fractions of a sweep's points that lie on the map's planes.
struct InlierRatios {
  double all = 0.0;
  /// Of the points of upright planes: floor and ceiling fit at any place and heading. Of all points
  /// if there are hardly any of these.
  double upright = 0.0;
};

/// `max_m`: the greatest distance from a plane. The points are as `sweep` has them deskewed.
[[nodiscard]] InlierRatios count_inliers(const VoxelMap::Selection& sweep,
                                         const CorrespondenceSearch& map,
                                         const geometry::SE3& T_map_base, double max_m);

/// The fraction of the points of walls across a direction (their normals are within 60 degrees of
/// it) that lie on the map's planes: these alone tell how far along it the robot is. Empty if there
/// are hardly any. `direction_map`: a unit vector.
[[nodiscard]] std::optional<double> inlier_ratio_across(const VoxelMap::Selection& sweep,
                                                        const CorrespondenceSearch& map,
                                                        const geometry::SE3& T_map_base,
                                                        const Eigen::Vector3d& direction_map,
                                                        double max_m);

}  // namespace nodmap::slam6d
