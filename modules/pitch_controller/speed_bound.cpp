// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/speed_bound.hpp"

#include <algorithm>

namespace nodmap::pitch_controller {
namespace {

// Allows for the lag of the wheels behind the command.
constexpr double kHeadroomMps = 0.2;
// Left before an obstacle for which the robot stops with all of its brakes' force.
constexpr double kMinLeftM = 0.05;
// Halvings of the interval in which the bound lies: to 0.3 mm/s.
constexpr int kHalvings = 14;

}  // namespace

double speed_bound(const ComingSweeps& sweeps, const UnseenPlaces& unseen,
                   const VirtualCorridor& corridor, const robot::Braking& braking,
                   const DetectionParams& detection) {
  const ClearView& view = sweeps.view;
  if (!(view.far_m > view.near_m) || !(sweeps.nod.rate_rad_s > 0.0)) {
    return 0.0;
  }
  double most_mps = braking.permitted_mps(view.far_m, detection.processing_s);
  const double protected_m = std::min(unseen.least_protected_m(), view.far_m);
  const auto stops = [&](double v) {
    const double d_min_m = braking.required_distance_m(v, detection.processing_s);
    const double comes_m = view.far_m - v * revisit_s(corridor, sweeps.nod, view.far_m, v);
    const double was_there_m =
        unseen.nearest_hit_m(sweeps.nod, revisit_s(corridor, sweeps.nod, protected_m, v), v);
    const double emergency_m =
        kMinLeftM +
        robot::stopping_distance(v, detection.processing_s, braking.emergency_deceleration_mps2);
    const double met_m =
        corridor.met_from_m(d_min_m + sweeps.short_of_m, detection.visible_obstacle_m);
    return comes_m >= std::max(view.near_m, d_min_m) && was_there_m >= std::max(met_m, emergency_m);
  };
  double least_mps = 0.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double v = 0.5 * (least_mps + most_mps);
    (stops(v) ? least_mps : most_mps) = v;
  }
  return least_mps;
}

double RisingBound::limit(double bound_mps, double present_mps, double dt_s) {
  const double from_mps = std::max(told_mps_, present_mps);
  told_mps_ =
      std::min({bound_mps, from_mps + acceleration_mps2_ * dt_s, present_mps + kHeadroomMps});
  return told_mps_;
}

}  // namespace nodmap::pitch_controller
