// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/slide_search.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/registration/dense_solvers.hpp"
#include "modules/slam6d/correspondence_search.hpp"
#include "modules/slam6d/heading_search.hpp"
#include "modules/slam6d/inliers.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// A prior with a larger standard deviation is wide: door frames are then farther off than the
// finest voxels reach (15 cm), and coarser voxels do not show them.
constexpr double kWideM = 0.2;
// The sweep slides as far as the prior may be wrong, in steps that no inlier (3 cm) misses.
constexpr double kSlideSigmas = 3.0;
constexpr double kMaxSlideM = 3.0;
constexpr double kSlideStepM = 0.02;
// Places whose inlier ratios are lower than the highest by less than this fit as well.
constexpr double kAsGood = 0.05;
// A place that is known no better than this leaves the direction to odometry.
constexpr double kKnownM = 0.1;

double sigma_along(const Matrix6d& covariance, const Eigen::Vector3d& axis) {
  return std::sqrt(axis.dot(covariance.topLeftCorner<3, 3>() * axis));
}

Eigen::Vector3d least_determined_axis(const Matrix6d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance.topLeftCorner<3, 3>());
  return eigen.eigenvectors().col(2);
}

// Where a sweep fits best along an axis, in metres from the middle of the slide.
struct Stretch {
  double middle_m = 0.0;
  double sigma_m = 0.0;
};

// Slides a sweep by up to `reach_m` to both sides of a pose.
Stretch slide(const VoxelMap& sweep_base, const VoxelMap& map, const SE3& T_map_base,
              const Eigen::Vector3d& axis, double reach_m, const RegistrationParams& params) {
  const VoxelMap::Selection points = sweep_base.select(0);
  const CorrespondenceSearch correspondences(map, params.min_normal_cosine);
  const int reach = static_cast<int>(std::ceil(reach_m / kSlideStepM));
  std::vector<double> ratios;
  for (int i = -reach; i <= reach; ++i) {
    SE3 T_map_slid = T_map_base;
    T_map_slid.translation() += i * kSlideStepM * axis;
    ratios.push_back(count_inliers(points, correspondences, T_map_slid,
                                   kInlierScales * params.fine_residual_scale_m)
                         .upright);
  }
  const double least = std::ranges::max(ratios) - kAsGood;
  double num = 0.0;
  double sum_m = 0.0;
  double sq_sum_m2 = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    if (ratios[static_cast<std::size_t>(i + reach)] >= least) {
      const double offset_m = i * kSlideStepM;
      num += 1.0;
      sum_m += offset_m;
      sq_sum_m2 += offset_m * offset_m;
    }
  }
  const double middle_m = sum_m / num;
  return {.middle_m = middle_m,
          .sigma_m = std::sqrt(std::max(0.0, sq_sum_m2 / num - middle_m * middle_m) +
                               kSlideStepM * kSlideStepM)};
}

// The prior, where the position along an axis is known to be at a pose.
PosePrior narrowed(const PosePrior& prior, const Eigen::Vector3d& axis, const SE3& T_map_base,
                   double sigma_m) {
  PosePrior narrow = prior;
  narrow.T_map_base.translation() +=
      axis.dot(T_map_base.translation() - prior.T_map_base.translation()) * axis;
  Matrix6d information = registration::inverse(prior.covariance);
  information.topLeftCorner<3, 3>() += axis * axis.transpose() / (sigma_m * sigma_m);
  narrow.covariance = registration::inverse(information);
  return narrow;
}

}  // namespace

Registration register_sweep_sliding(VoxelMap& sweep_base, const VoxelMap& map,
                                    const PosePrior& prior, const RegistrationParams& params) {
  const auto as_measured = sweep_base.is_moving() ? std::optional(sweep_base) : std::nullopt;
  const Registration found = register_sweep(sweep_base, map, prior, params);
  const Eigen::Vector3d axis = least_determined_axis(found.covariance);
  const double prior_sigma_m = sigma_along(prior.covariance, axis);
  if (!found.is_accepted() || !(prior_sigma_m > kWideM)) {
    return found;
  }
  SE3 T_map_middle = found.T_map_base;
  T_map_middle.translation() +=
      axis.dot(prior.T_map_base.translation() - found.T_map_base.translation()) * axis;
  const Stretch stretch = slide(sweep_base, map, T_map_middle, axis,
                                std::min(kSlideSigmas * prior_sigma_m, kMaxSlideM), params);
  // Joined with the prior: where the sweep fits everywhere, it stays there.
  const double weight =
      1.0 / (1.0 + stretch.sigma_m * stretch.sigma_m / (prior_sigma_m * prior_sigma_m));
  const double sigma_m = std::sqrt(weight) * stretch.sigma_m;
  SE3 T_map_start = T_map_middle;
  T_map_start.translation() += weight * stretch.middle_m * axis;
  VoxelMap sweep = as_measured.value_or(sweep_base);
  Registration slid = register_sweep_from(sweep, map, narrowed(prior, axis, T_map_start, sigma_m),
                                          T_map_start, params);
  if (!slid.is_accepted()) {
    return found;
  }
  sweep_base = std::move(sweep);
  const Eigen::Matrix3d spread = sigma_m * sigma_m * axis * axis.transpose();
  slid.covariance.topLeftCorner<3, 3>() += spread;
  slid.end_covariance.topLeftCorner<3, 3>() += spread;
  if (sigma_m > kKnownM) {
    slid.state = PoseState::kDegraded;
    slid.degenerate_directions = std::max(slid.degenerate_directions, 1);
  }
  return slid;
}

}  // namespace nodmap::slam6d
