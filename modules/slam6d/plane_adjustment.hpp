// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/registration.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// How the keyframes are adjusted together at the end.
struct AdjustmentParams {
  bool use = true;
  double patch_size_m = 0.4;
  double residual_scale_m = 0.008;

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("use_adjustment", use,
           "At the end all keyframes are moved together to where their planes agree best.");
    v.number("patch_size_m", patch_size_m, {0.05, 5.0},
             "Edge of the cubes within which what all keyframes saw is taken as one plane.");
    v.number("residual_scale_m", residual_scale_m, {0.001, 1.0},
             "Scale of the robust kernel; beyond it a point loses weight.");
  }
};

/// A sweep whose pose is adjusted.
struct AdjustedSweep {
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  VoxelMap voxels;  ///< in base
  /// The motion from the sweep before to this one, as odometry and matches with the map told it,
  /// and its covariance (position in m, rotation vector in rad, axes of map); not of the first.
  geometry::SE3 T_last_this = geometry::SE3::Identity();
  Matrix6d covariance = Matrix6d::Identity();
  /// Where the ground is level.
  std::optional<PosePrior::Level> level = std::nullopt;
};

/// The poses at which the sweeps' planes agree best, all sweeps at once; the first stays. One
/// Gauss-Newton step from the present poses, which are right to some centimetres.
///
/// What all sweeps saw within a cube and facing one way is a patch: one plane, whose offset and
/// tilts are unknowns as the poses are, and are eliminated (plane adjustment: Ferrer 2019, Liu and
/// Zhang 2021). The motion between successive sweeps holds what no plane tells. Where the equations
/// have no solution the poses are returned as they are.
[[nodiscard]] std::vector<geometry::SE3> adjust_planes(std::span<const AdjustedSweep> sweeps,
                                                       const VoxelMapParams& voxels,
                                                       const RegistrationParams& registration,
                                                       const AdjustmentParams& params);

}  // namespace nodmap::slam6d
