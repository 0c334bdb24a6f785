// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/heading_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// Headings at which registration starts when in doubt. It converges from some 10 degrees. Starts
// reach as far as the prior may be wrong, at most 84 degrees.
constexpr double kHeadingStepRad = geometry::deg_to_rad(12.0);
constexpr double kHeadingSigmas = 3.0;
constexpr double kMaxHeadingSteps = 7.0;
// The result of another start is taken if its inlier ratio is higher by this.
constexpr double kClearlyBetter = 0.1;

}  // namespace

Registration register_sweep(VoxelMap& sweep_base, const VoxelMap& map, const PosePrior& prior,
                            const RegistrationParams& params) {
  // Registration deskews what it registers.
  const auto as_measured = sweep_base.is_moving() ? std::optional(sweep_base) : std::nullopt;
  Registration best = register_sweep_from(sweep_base, map, prior, prior.T_map_base, params);
  if (best.is_accepted() && best.lowest_inlier_ratio() >= params.good_inlier_ratio) {
    return best;
  }
  const Eigen::Vector3d up_map = prior.T_map_base.linear().col(2);
  const double heading_sigma_rad =
      std::sqrt(up_map.dot(prior.covariance.bottomRightCorner<3, 3>() * up_map));
  const int num_steps = static_cast<int>(std::min(
      kMaxHeadingSteps, std::ceil(kHeadingSigmas * heading_sigma_rad / kHeadingStepRad - 0.5)));
  for (int i = 1; i <= 2 * num_steps; ++i) {
    // 1, -1, 2, -2, ...
    const int steps = (i + 1) / 2 * (i % 2 == 1 ? 1 : -1);
    const double offset_rad = kHeadingStepRad * steps;
    SE3 T_map_start = prior.T_map_base;
    T_map_start.linear() = geometry::rotation_of(offset_rad * up_map) * T_map_start.linear();
    VoxelMap sweep = as_measured.value_or(sweep_base);
    const Registration other = register_sweep_from(sweep, map, prior, T_map_start, params);
    const double to_beat = best.is_accepted() ? best.lowest_inlier_ratio() + kClearlyBetter : 0.0;
    if (other.is_accepted() && other.lowest_inlier_ratio() > to_beat) {
      best = other;
      sweep_base = std::move(sweep);
    }
  }
  return best;
}

}  // namespace nodmap::slam6d
