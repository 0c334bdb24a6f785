// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/speed_bound.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::pitch_controller {

ClearView clear_view(const VirtualCorridor& corridor, const PitchInterval& seen,
                     double line_spacing_rad, double obstacle_m, double look_ahead_m) {
  // Lines are dp (d^2 + h^2) / d apart on what stands upright at d: equal to the obstacle at
  //   d = (o -+ sqrt(o^2 - 4 dp^2 h^2)) / 2 dp, and denser between.
  const double lever_m = 2.0 * line_spacing_rad * corridor.axis_height_m;
  const double root_sq = obstacle_m * obstacle_m - lever_m * lever_m;
  if (root_sq < 0.0 || !(line_spacing_rad > 0.0)) {
    return {};
  }
  const double root = std::sqrt(root_sq);
  const double dense_from_m =
      0.5 * (obstacle_m - root) / line_spacing_rad - corridor.axis_behind_front_m;
  const double dense_until_m =
      0.5 * (obstacle_m + root) / line_spacing_rad - corridor.axis_behind_front_m;
  // The outermost line may lie anywhere up to one spacing within the end of the sweep.
  const PitchInterval lines{seen.min_rad + line_spacing_rad, seen.max_rad - line_spacing_rad};
  return {std::max(corridor.covered_from_m(lines), dense_from_m),
          std::min(dense_until_m, look_ahead_m)};
}

double speed_bound(const ClearView& view, double sweep_s, const Stopping& stopping) {
  if (!(view.far_m > view.near_m) || !(sweep_s > 0.0)) {
    return 0.0;
  }
  return std::min(stopping.speed_mps(view.far_m, stopping.reaction_s(sweep_s)),
                  (view.far_m - view.near_m) / (2.0 * sweep_s));
}

}  // namespace nodmap::pitch_controller
