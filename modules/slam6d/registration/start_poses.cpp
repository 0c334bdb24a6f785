// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/start_poses.hpp"

#include <algorithm>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

constexpr std::size_t kMaxStarts = 8;
// Start poses within this of a better one are left out.
constexpr geometry::PoseTolerance kSameStart{.distance_m = 0.7,
                                             .rotation_rad = geometry::deg_to_rad(10.0)};
// Registrations from different start poses that end within this are the same place.
constexpr geometry::PoseTolerance kSamePlace{.distance_m = 0.5 * kSameStart.distance_m,
                                             .rotation_rad = 0.5 * kSameStart.rotation_rad};
// Another place fits as well if its inlier ratio is lower by less than this.
constexpr double kAmbiguity = 0.1;

}  // namespace

std::vector<StartPose> best_starts(std::vector<StartPose> tried) {
  std::ranges::stable_sort(tried, std::ranges::greater{}, &StartPose::score);
  std::vector<StartPose> best;
  for (const StartPose& start : tried) {
    if (best.size() == kMaxStarts) {
      break;
    }
    if (std::ranges::all_of(best, [&](const StartPose& better) {
          return !geometry::is_within(better.T_map_base, start.T_map_base, kSameStart);
        })) {
      best.push_back(start);
    }
  }
  return best;
}

StartsResult register_from(std::span<const StartPose> starts, VoxelMap& sweep_base,
                           const VoxelMap& map,
                           const std::function<PosePrior(const SE3& T_map_start)>& prior_at,
                           const std::function<bool(const SE3& T_map_base)>& is_possible,
                           const RegistrationParams& params) {
  std::vector<Registration> found;
  for (const StartPose& start : starts) {
    const Registration registration =
        register_sweep_from(sweep_base, map, prior_at(start.T_map_base), start.T_map_base, params);
    if (registration.is_accepted() && is_possible(registration.T_map_base)) {
      found.push_back(registration);
    }
  }
  const auto ratio = [](const Registration& one) { return one.lowest_inlier_ratio(); };
  const auto best = std::ranges::max_element(found, {}, ratio);
  if (best == found.end()) {
    return {};
  }
  const bool is_ambiguous = std::ranges::any_of(found, [&](const Registration& other) {
    return ratio(other) > ratio(*best) - kAmbiguity &&
           !geometry::is_within(best->T_map_base, other.T_map_base, kSamePlace);
  });
  return is_ambiguous ? StartsResult{.is_ambiguous = true} : StartsResult{.best = *best};
}

}  // namespace nodmap::slam6d
