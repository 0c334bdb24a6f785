// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/slip_search.hpp"

#include <utility>
#include <vector>

#include "modules/slam6d/registration/inliers.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// A shorter motion is within what registration corrects without help: the coarsest kernel is wider.
constexpr double kShortestM = 0.1;
// Less than this ratio of the walls across the motion on the map is doubtful. In known places it is
// above 0.8, so that the search is rarely needed.
constexpr double kDoubtfulRatio = 0.6;
// Farther from odometry than this, in standard deviations, wheels that grip are hardly ever.
constexpr double kDoubtfulDistance = 4.0;
// The result is taken if at most this ratio of the walls that did not fit still does not.
constexpr double kMaxMisfitRatio = 0.5;
// Standard deviation of what the robot did of the motion, as a ratio of it: anything from none to
// all.
constexpr double kSlipShare = 0.4;

// The walls across the motion, of a sweep at a pose.
std::optional<double> ratio_across(const VoxelMap& sweep_base, const VoxelMap& map,
                                   const SE3& T_map_base, const CountedMotion& counted,
                                   const RegistrationParams& params) {
  return inlier_ratio_across(sweep_base.select(0), {map, params.min_normal_cosine}, T_map_base,
                             counted.to_last_m.normalized(),
                             kInlierScales * params.fine_residual_scale_m);
}

// Where an obstacle stopped the robot. What is seen late in a sweep need not show that, so it may
// have been in the middle of the last one.
std::vector<Eigen::Vector3d> stops(const CountedMotion& counted) {
  std::vector<Eigen::Vector3d> p_map{counted.T_map_last.translation()};
  const SE3 T_map_middle = counted.T_map_last * counted.last_motion.inverse();
  if (T_map_middle.translation() != p_map.front()) {
    p_map.emplace_back(T_map_middle.translation());
  }
  return p_map;
}

// Whether the cloud is the same after stop(), as its voxels are.
bool is_stopped(const SweepCloud& cloud, const VoxelMap& sweep_base) {
  return !sweep_base.is_moving() && cloud.T_base_first.translation().isZero(0.0) &&
         cloud.T_base_last.translation().isZero(0.0);
}

Matrix6d widened(Matrix6d covariance, double sigma_m) {
  covariance.diagonal().head<3>().array() += sigma_m * sigma_m;
  return covariance;
}

}  // namespace

bool is_far_from_odometry(const Registration& registration) {
  return registration.prior_distance > kDoubtfulDistance;
}

std::optional<double> doubtful_ratio(const VoxelMap& sweep_base, const VoxelMap& map,
                                     const Registration& as_counted, const CountedMotion& counted,
                                     const RegistrationParams& params) {
  if (counted.to_last_m.norm() < kShortestM) {
    return std::nullopt;
  }
  const auto ratio = ratio_across(sweep_base, map, as_counted.T_map_base, counted, params);
  return ratio && (*ratio < kDoubtfulRatio || is_far_from_odometry(as_counted)) ? ratio
                                                                                : std::nullopt;
}

std::optional<SlippedSweep> register_slipped(const SweepCloud& cloud, const VoxelMap& sweep_base,
                                             const VoxelMap& map, const PosePrior& prior,
                                             const Registration& as_counted,
                                             const CountedMotion& counted,
                                             const RegistrationParams& params,
                                             const VoxelMapParams& voxels) {
  PosePrior slipped = prior;
  slipped.covariance =
      widened(prior.covariance,
              kSlipShare * (counted.to_first_m.norm() + counted.last_motion.translation().norm()));
  slipped.motion_covariance =
      widened(prior.motion_covariance, kSlipShare * cloud.motion().translation().norm());
  double misfit_to_beat =
      (is_far_from_odometry(as_counted) ? 1.0 : kMaxMisfitRatio) * (1.0 - counted.inlier_ratio);
  std::optional<SweepCloud> cloud_anew;
  std::optional<VoxelMap> voxels_anew;
  if (!is_stopped(cloud, sweep_base)) {
    cloud_anew = cloud;
    cloud_anew->stop();
    voxels_anew = voxelize(*cloud_anew, voxels);
  }
  const SweepCloud& stopped = cloud_anew ? *cloud_anew : cloud;
  const VoxelMap& stopped_voxels = voxels_anew ? *voxels_anew : sweep_base;
  std::optional<SlippedSweep> best;
  for (const Eigen::Vector3d& p_map_stop : stops(counted)) {
    VoxelMap sweep = stopped_voxels;
    slipped.T_map_base.translation() = p_map_stop;
    Registration found = register_sweep_from(sweep, map, slipped, slipped.T_map_base, params);
    const auto ratio = ratio_across(sweep, map, found.T_map_base, counted, params);
    if (found.state == PoseState::kTracking && ratio && 1.0 - *ratio < misfit_to_beat &&
        found.lowest_inlier_ratio() >= as_counted.lowest_inlier_ratio()) {
      misfit_to_beat = 1.0 - *ratio;
      found.is_slipped = true;
      best = {stopped, std::move(sweep), found};
    }
  }
  return best;
}

}  // namespace nodmap::slam6d
