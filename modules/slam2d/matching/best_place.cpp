// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/best_place.hpp"

#include <algorithm>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam2d {
namespace {

constexpr geometry::PoseTolerance kSamePlace{.distance_m = 0.5, .rotation_rad = 0.2};
// Minimum difference of the scores: where nearly every point fits, the ratio of the misfits means
// little.
constexpr double kMinMargin = 0.02;

}  // namespace

bool is_same_place(const geometry::SE2& a, const geometry::SE2& b) {
  return geometry::is_within(a, b, kSamePlace);
}

bool BestPlace::is_clear(double min_misfit_ratio) const {
  return runner_up_score <= 1.0 - min_misfit_ratio * (1.0 - score) - kMinMargin;
}

BestPlace best_of(std::span<const Peak> places) {
  const auto best = std::max_element(
      places.begin(), places.end(), [](const Peak& a, const Peak& b) { return a.score < b.score; });
  BestPlace result{static_cast<std::size_t>(best - places.begin()), best->score};
  for (const Peak& place : places) {
    if (!is_same_place(place.T_target_base, best->T_target_base)) {
      result.runner_up_score = std::max(result.runner_up_score, place.score);
    }
  }
  return result;
}

}  // namespace nodmap::slam2d
