// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/registration/registration.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// How the robot moved up to the last beam of a sweep, as odometry counted it, since the last sweep
/// whose pose is known.
struct CountedMotion {
  geometry::SE3 T_map_last = geometry::SE3::Identity();  ///< where that sweep ended
  /// From the middle of that sweep to its end. If the wheels began to slip meanwhile, nothing that
  /// was seen later in that sweep need have shown it.
  geometry::SE3 last_motion = geometry::SE3::Identity();
  Eigen::Vector3d to_first_m = Eigen::Vector3d::Zero();  ///< to the first beam, axes of map
  Eigen::Vector3d to_last_m = Eigen::Vector3d::Zero();   ///< to the last beam, axes of map
  double inlier_ratio = 0.0;                             ///< doubtful_ratio()
};

/// Whether a pose is so far from odometry that it is not certain.
[[nodiscard]] bool is_far_from_odometry(const Registration& registration);

/// The fraction of the walls across the motion (inlier_ratio_across()) that lie on the map, if the
/// motion is doubtful: because so few do, or because the pose is far from odometry. In new places
/// the map has none, so this is no proof that the wheels slipped.
[[nodiscard]] std::optional<double> doubtful_ratio(const VoxelMap& sweep_base, const VoxelMap& map,
                                                   const Registration& as_counted,
                                                   const CountedMotion& counted,
                                                   const RegistrationParams& params);

/// A sweep during or before which the wheels slipped, deskewed and registered accordingly.
struct SlippedSweep {
  SweepCloud cloud;
  VoxelMap voxels;
  Registration registration;
};

/// Registers a sweep of a doubtful motion as if the wheels had slipped: as if the robot had been
/// stopped before the sweep, with a prior that allows any part of the motion. Returns the
/// result with which the walls across the motion fit best, if they fit clearly better than in
/// `as_counted` (better, if that is far from odometry), and no fewer of all points fit. Empty
/// otherwise, as in a bare corridor, which looks the same all along. `cloud`: as odometry counted
/// the motion. `sweep_base`: its voxels, deskewed by that registration.
[[nodiscard]] std::optional<SlippedSweep> register_slipped(
    const SweepCloud& cloud, const VoxelMap& sweep_base, const VoxelMap& map,
    const PosePrior& prior, const Registration& as_counted, const CountedMotion& counted,
    const RegistrationParams& params, const VoxelMapParams& voxels);

}  // namespace nodmap::slam6d
