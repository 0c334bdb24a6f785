// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/slide_search.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/registration/dense_solvers.hpp"
#include "modules/slam6d/registration/correspondence_search.hpp"
#include "modules/slam6d/registration/heading_search.hpp"
#include "modules/slam6d/registration/inliers.hpp"

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
// Numbers of wall points that slide: the least that determine a place, and so many as show it as
// well as all. After an interruption these take the time of some ten full counts of inliers.
constexpr std::size_t kMinPoints = 30;
constexpr std::size_t kMaxPoints = 500;
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

// A point on a wall, as it lies in the map before the slide.
struct WallPoint {
  Eigen::Vector3f p;
  Eigen::Vector3f normal;
  std::size_t level;
};

// Some points of upright planes, spread over all of them.
std::vector<WallPoint> wall_points(const VoxelMap& sweep_base, const SE3& T_map_base) {
  const VoxelMap::Selection points = sweep_base.select(0);
  const Eigen::Isometry3f to_map = T_map_base.cast<float>();
  std::vector<WallPoint> all;
  for (std::size_t l = 0; l < VoxelMap::kLevels; ++l) {
    for (std::size_t i = points.first_of_level[l]; i < points.first_of_level[l + 1]; ++i) {
      const Eigen::Vector3f normal = to_map.linear() * points.points[i].normal;
      if (is_upright(normal.z())) {
        all.push_back({to_map * points.points[i].p, normal, l});
      }
    }
  }
  return some_of(all, kMaxPoints);
}

// The fraction of the points near planes of the map that lie on them. Where the map knows nothing,
// a point says nothing: at the end of a map the sweep would otherwise fit better farther back.
double fit_ratio(std::span<const WallPoint> points, const CorrespondenceSearch& map,
                 const Eigen::Vector3f& step, float max_m) {
  std::size_t known = 0;
  std::size_t on = 0;
  for (const WallPoint& point : points) {
    const FitToPlane fit = map.fit(point.level, point.p + step, point.normal, max_m);
    known += fit == FitToPlane::kUnknown ? 0 : 1;
    on += fit == FitToPlane::kOn ? 1 : 0;
  }
  return static_cast<double>(on) / static_cast<double>(std::max<std::size_t>(1, known));
}

// Where a sweep fits best along an axis, in metres from the middle of the slide.
struct Stretch {
  double middle_m = 0.0;
  double sigma_m = 0.0;
};

// The places that fit as well as the best, of ratios from -reach to reach steps. Empty if they
// reach an end of the slide: then it does not show where they end.
std::optional<Stretch> best_stretch(std::span<const double> ratios, int reach) {
  const double least = std::ranges::max(ratios) - kAsGood;
  if (ratios.front() >= least || ratios.back() >= least) {
    return std::nullopt;
  }
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
  return Stretch{.middle_m = middle_m,
                 .sigma_m = std::sqrt(std::max(0.0, sq_sum_m2 / num - middle_m * middle_m) +
                                      kSlideStepM * kSlideStepM)};
}

// Slides a sweep by up to `reach_m` to both sides of a pose.
std::optional<Stretch> slide(const VoxelMap& sweep_base, const VoxelMap& map, const SE3& T_map_base,
                             const Eigen::Vector3d& axis, double reach_m,
                             const RegistrationParams& params) {
  const std::vector<WallPoint> points = wall_points(sweep_base, T_map_base);
  if (points.size() < kMinPoints) {
    return std::nullopt;
  }
  const CorrespondenceSearch correspondences(map, params.min_normal_cosine);
  const auto max_m = static_cast<float>(kInlierScales * params.fine_residual_scale_m);
  const int reach = static_cast<int>(std::ceil(reach_m / kSlideStepM));
  std::vector<double> ratios;
  for (int i = -reach; i <= reach; ++i) {
    ratios.push_back(
        fit_ratio(points, correspondences, (i * kSlideStepM * axis).cast<float>(), max_m));
  }
  return best_stretch(ratios, reach);
}

// The prior joined with what the slide shows about the position along an axis.
PosePrior joined(const PosePrior& prior, const Eigen::Vector3d& axis, const Stretch& stretch) {
  PosePrior joined = prior;
  Matrix6d information = registration::inverse(prior.covariance);
  information.topLeftCorner<3, 3>() +=
      axis * axis.transpose() / (stretch.sigma_m * stretch.sigma_m);
  joined.covariance = registration::inverse(information);
  const double gain = std::pow(sigma_along(joined.covariance, axis) / stretch.sigma_m, 2);
  joined.T_map_base.translation() += gain * stretch.middle_m * axis;
  return joined;
}

// Neighbours that are not the same surface seem to determine a place better than the slide does.
void widen(Matrix6d& covariance, const Eigen::Vector3d& axis, double sigma_m) {
  const double variance_m2 = axis.dot(covariance.topLeftCorner<3, 3>() * axis);
  const double missing_m2 = std::max(0.0, sigma_m * sigma_m - variance_m2);
  covariance.topLeftCorner<3, 3>() += missing_m2 * axis * axis.transpose();
}

}  // namespace

Registration register_sweep_sliding(VoxelMap& sweep_base, const VoxelMap& map,
                                    const PosePrior& prior, const RegistrationParams& params) {
  const auto as_measured = sweep_base.is_moving() ? std::optional(sweep_base) : std::nullopt;
  Registration found = register_sweep(sweep_base, map, prior, params);
  const Eigen::Vector3d axis = least_determined_axis(found.covariance);
  const double prior_sigma_m = sigma_along(prior.covariance, axis);
  if (!found.is_accepted() || !(prior_sigma_m > kWideM)) {
    return found;
  }
  const SE3& T_map_found = found.T_map_base;
  SE3 T_map_middle = T_map_found;
  T_map_middle.translation() +=
      axis.dot(prior.T_map_base.translation() - T_map_found.translation()) * axis;
  const auto stretch = slide(sweep_base, map, T_map_middle, axis,
                             std::min(kSlideSigmas * prior_sigma_m, kMaxSlideM), params);
  if (!stretch) {
    return found;
  }
  const PosePrior narrowed = joined(prior, axis, *stretch);
  SE3 T_map_start = T_map_middle;
  T_map_start.translation() += narrowed.T_map_base.translation() - prior.T_map_base.translation();
  VoxelMap sweep = as_measured.value_or(sweep_base);
  Registration slid = register_sweep_from(sweep, map, narrowed, T_map_start, params);
  if (!slid.is_accepted() || slid.lowest_inlier_ratio() < found.lowest_inlier_ratio()) {
    return found;
  }
  sweep_base = std::move(sweep);
  const double sigma_m = sigma_along(narrowed.covariance, axis);
  widen(slid.covariance, axis, sigma_m);
  widen(slid.end_covariance, axis, sigma_m);
  if (sigma_m > kKnownM) {
    slid.state = PoseState::kDegraded;
    slid.degenerate_directions = std::max(slid.degenerate_directions, 1);
  }
  return slid;
}

}  // namespace nodmap::slam6d
