// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/registration/registration.hpp"

namespace nodmap::slam6d {

/// The joint adjustment of keyframes and the sweeps in between at the end.
struct AdjustmentParams {
  bool use = true;
  double voxel_size_m = 0.08;
  double patch_size_m = 0.4;
  double residual_scale_m = 0.015;
  double sweep_distance_m = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag(
        "use_adjustment", use,
        "At the end move all keyframes, and the sweeps in between, together to where their planes "
        "agree best.");
    v.number("voxel_size_m", voxel_size_m, {0.01, 1.0},
             "Edge of the voxels within which the points of a sweep are averaged. Finer than those "
             "of registration, because no point needs a plane of its own here.");
    v.number("patch_size_m", patch_size_m, {0.05, 5.0},
             "Edge of the cubes within which the points of all sweeps are taken as one plane.");
    v.number(
        "residual_scale_m", residual_scale_m, {0.001, 1.0},
        "Scale of the robust kernel for a single measured point, which loses weight beyond it. "
        "The scale of a mean of many points is smaller, as its standard deviation is.");
    v.number("sweep_distance_m", sweep_distance_m, {0.0, 1000.0},
             "A sweep between keyframes takes part if its base pose is farther than this from the "
             "last one that does; the others follow their neighbours.");
  }
};

/// The mean of the points that a sweep measured within one voxel.
struct MeanPoint {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
  float num_points = 0.0F;
};

/// The points of a sweep as they are adjusted, in the same frame.
[[nodiscard]] std::vector<MeanPoint> adjusted_points(std::span<const Eigen::Vector3f> points,
                                                     const AdjustmentParams& params);

/// A sweep whose pose is adjusted.
struct AdjustedSweep {
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  std::vector<MeanPoint> points = {};  ///< in base
  /// The planes of all voxel sizes, in base. They tell which way patches face. May be empty if
  /// other sweeps saw the same.
  std::vector<OrientedPoint> planes = {};
  /// The motion from an earlier sweep to this one, from odometry and matches with the map, and its
  /// covariance (position in m, rotation vector in rad, axes of map). Not used for the first sweep.
  std::size_t from = 0;
  geometry::SE3 T_from_this = geometry::SE3::Identity();
  Matrix6d covariance = Matrix6d::Identity();
  /// Set if the ground is level.
  std::optional<PosePrior::Level> level = std::nullopt;
};

/// Computes the poses of all sweeps at which their planes agree best; the first pose is fixed.
/// Performs one Gauss-Newton step from the present poses, which must be right to some centimetres.
/// If a motion between sweeps is so uncertain that the planes of both may lie outside the robust
/// kernel, one step with a wider kernel comes first.
///
/// A patch is what all sweeps saw within one cube, from its front: one plane, whose offset and
/// tilts are unknowns like the poses, and are eliminated (plane adjustment: Ferrer 2019, Liu and
/// Zhang 2021). The motions between successive sweeps determine what no plane does. If the
/// equations have no solution, the poses are returned unchanged.
[[nodiscard]] std::vector<geometry::SE3> adjust_planes(std::vector<AdjustedSweep> sweeps,
                                                       const VoxelMapParams& voxels,
                                                       const RegistrationParams& registration,
                                                       const AdjustmentParams& params);

}  // namespace nodmap::slam6d
