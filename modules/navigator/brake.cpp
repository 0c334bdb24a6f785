// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/brake.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {

Arc Brake::measure_arc(double curvature, const Situation& now) const {
  Arc arc = measure_corridor(curvature, drive_.side_margin_m, now);
  if (creeps_ && arc.speed_mps < drive_.creep_mps) {
    Arc narrow = measure_corridor(curvature, drive_.creep_margin_m, now);
    narrow.speed_mps = std::min(narrow.speed_mps, drive_.creep_mps);
    if (narrow.speed_mps > arc.speed_mps) {
      arc = narrow;
    }
  }
  if (now.local_map != nullptr) {
    const double limit_mps = std::min(arc.speed_mps, drive_.max_forward_mps);
    arc.speed_mps = std::min(arc.speed_mps, speed_on_seen_floor(curvature, limit_mps, now));
  }
  return arc;
}

Arc Brake::measure_corridor(double curvature, double side_margin_m, const Situation& now) const {
  const double distance_m = free_distance(now.points_base, curvature, body_, side_margin_m);
  return {curvature, distance_m, braking_.stoppable_mps(distance_m, drive_.reaction_s)};
}

/// Why the robot never drives faster than it can stop on floor that was seen. Let F(g) be how far
/// floor was seen with no gap longer than g. From a speed v it is stationary within
/// d(v) = v T + v^2 / 2a. Both
///
///     v <= v(F(wide gap), a: braking)    and    v <= v(F(max gap), a: emergency braking)
///
/// hold in every decision, for the arc chosen and for the arc it is on. F shrinks by no more than
/// the robot drives, for what was seen stays seen; and while it brakes with a, v(F) falls no faster
/// than v, see stopping.hpp. So a hole as long as the wide gap, in which a beam has been, is
/// stopped for like an obstacle; one as long as the max gap with the force that the base has in
/// reserve. Ground shorter than that between two places that are floor carries the wheels over it.
double Brake::speed_on_seen_floor(double curvature, double max_mps, const Situation& now) const {
  struct Rule {
    double max_gap_m;
    double deceleration_mps2;
  };
  double speed_mps = max_mps;
  for (const Rule& rule : {Rule{local_map_.wide_gap_m, braking_.deceleration_mps2},
                           Rule{local_map_.max_gap_m, braking_.emergency_deceleration_mps2}}) {
    const double longest_m =
        robot::stopping_distance(speed_mps, drive_.reaction_s, rule.deceleration_mps2);
    const double seen_m = now.local_map->seen_distance(
        now.T_odom_base, curvature, body_.half_width_m, longest_m, rule.max_gap_m);
    if (seen_m < longest_m) {
      speed_mps = robot::stoppable_speed(seen_m, drive_.reaction_s, rule.deceleration_mps2);
    }
  }
  return speed_mps;
}

double Brake::speed_on_present_arc(const Situation& now) const {
  const double forward_mps = now.forward_mps;
  if (forward_mps < kLeastSpeedMps) {
    return std::numeric_limits<double>::infinity();
  }
  const Arc arc = measure_arc(now.yaw_rate_rad_s / forward_mps, now);
  const double emergency_mps = robot::stoppable_speed(arc.free_distance_m - braking_.stop_margin_m,
                                                      0.0, braking_.emergency_deceleration_mps2);
  return forward_mps > emergency_mps ? 0.0 : arc.speed_mps;
}

double Brake::speed_limit(double curvature, double max_forward_mps) const {
  const double bend = std::abs(curvature);
  double speed_mps = std::max(0.0, std::min(max_forward_mps, drive_.max_forward_mps));
  if (bend > 0.0) {
    speed_mps = std::min(
        {speed_mps, drive_.max_yaw_rate_rad_s / bend, std::sqrt(drive_.max_lateral_mps2 / bend)});
  }
  return speed_mps;
}

double Brake::stoppable_mps(double distance_m) const {
  return robot::stoppable_speed(distance_m, drive_.reaction_s, braking_.deceleration_mps2);
}

}  // namespace nodmap::navigator
