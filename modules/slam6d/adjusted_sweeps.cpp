// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/adjusted_sweeps.hpp"

#include <Eigen/LU>
#include <cstddef>

#include "modules/slam6d/odometry_prior.hpp"
#include "modules/slam6d/sweep_voxels.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// The motion from the last keyframe to this one, with its covariance in the axes of map.
struct Motion {
  SE3 T_last_this = SE3::Identity();
  Matrix6d covariance = Matrix6d::Identity();
};

Motion by_odometry(const Keyframe& last, const PoseUpdate& from, const PoseUpdate& to,
                   const Tracker& tracker, const OdometryParams& params) {
  const SE3 T_last_this = tracker.calibration().calibrate(
      (from.T_first_odom * from.T_odom_base).inverse() * to.T_first_odom * to.T_odom_base);
  return {T_last_this,
          odometry_covariance(last.T_map_base,
                              {.distance_m = T_last_this.translation().norm(),
                               .rotation_rad = geometry::rotation_angle(T_last_this),
                               .is_interrupted = to.keyframe == KeyframeReason::kInterruption,
                               .scatter = tracker.odometry_scatter()},
                              params)};
}

// The mean of two motions, weighted by their information.
Motion joined(const Motion& a, const Motion& b, const SE3& T_map_last) {
  const Eigen::Matrix3d& R_map_last = T_map_last.linear();
  Vector6d a_to_b;  // axes of map
  a_to_b << R_map_last * (b.T_last_this.translation() - a.T_last_this.translation()),
      R_map_last *
          geometry::rotation_vector(b.T_last_this.linear() * a.T_last_this.linear().transpose());
  const Matrix6d information_b = b.covariance.inverse();
  Motion both{a.T_last_this, (a.covariance.inverse() + information_b).inverse()};
  const Vector6d motion = both.covariance * information_b * a_to_b;
  both.T_last_this.translation() += R_map_last.transpose() * motion.head<3>();
  both.T_last_this.linear() =
      geometry::rotation_of(R_map_last.transpose() * motion.tail<3>()) * a.T_last_this.linear();
  return both;
}

}  // namespace

std::vector<AdjustedSweep> adjusted_sweeps(std::span<const Keyframe> keyframes,
                                           std::span<const PoseUpdate> updates,
                                           std::span<const registration::PoseEdge3d> steps,
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
      const Keyframe& last = keyframes[sweeps.size() - 2];
      const PoseUpdate& to = updates[keyframe.sweep];
      const Motion tracked{steps[sweeps.size() - 2].T_from_to, to.covariance};
      const Motion motion =
          joined(tracked, by_odometry(last, updates[last.sweep], to, tracker, params.odometry),
                 last.T_map_base);
      sweep.T_last_this = motion.T_last_this;
      sweep.covariance = motion.covariance;
    }
  }
  return sweeps;
}

}  // namespace nodmap::slam6d
