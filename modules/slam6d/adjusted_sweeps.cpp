// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/adjusted_sweeps.hpp"

#include <cstddef>

#include "modules/slam6d/odometry_prior.hpp"
#include "modules/slam6d/sweep_voxels.hpp"

namespace nodmap::slam6d {
namespace {

void add_odometry(AdjustedSweep& sweep, const Keyframe& last, const Keyframe& keyframe,
                  std::span<const PoseUpdate> updates, const Tracker& tracker,
                  const OdometryParams& params) {
  const PoseUpdate& from = updates[last.sweep];
  const PoseUpdate& to = updates[keyframe.sweep];
  sweep.T_last_this = tracker.calibration().calibrate(
      (from.T_first_odom * from.T_odom_base).inverse() * to.T_first_odom * to.T_odom_base);
  sweep.covariance =
      odometry_covariance(last.T_map_base,
                          {.distance_m = sweep.T_last_this.translation().norm(),
                           .rotation_rad = geometry::rotation_angle(sweep.T_last_this),
                           .is_interrupted = to.keyframe == KeyframeReason::kInterruption,
                           .scatter = tracker.odometry_scatter()},
                          params);
}

}  // namespace

std::vector<AdjustedSweep> adjusted_sweeps(std::span<const Keyframe> keyframes,
                                           std::span<const PoseUpdate> updates,
                                           const Tracker& tracker, const Slam6dParams& params) {
  std::vector<AdjustedSweep> sweeps;
  sweeps.reserve(keyframes.size());
  for (const Keyframe& keyframe : keyframes) {
    AdjustedSweep& sweep = sweeps.emplace_back(AdjustedSweep{
        .T_map_base = keyframe.T_map_base, .voxels = voxelize(*keyframe.cloud, params.voxels)});
    if (is_planar(keyframe.cloud->T_odom_base)) {
      sweep.level = {.height_m = 0.0,
                     .height_sigma_m = params.odometry.level_height_m,
                     .tilt_sigma_rad = params.odometry.level_tilt_rad};
    }
    if (sweeps.size() > 1) {
      add_odometry(sweep, keyframes[sweeps.size() - 2], keyframe, updates, tracker,
                   params.odometry);
    }
  }
  return sweeps;
}

}  // namespace nodmap::slam6d
