// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/brake.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {

Arc Brake::measure_arc(double curvature, const Situation& now) const {
  const double distance_m = free_distance(now.points_base, curvature, body_, drive_.side_margin_m);
  double speed_mps = braking_.stoppable_mps(distance_m, drive_.reaction_s);
  if (now.local_map != nullptr) {
    const double longest_m = robot::stopping_distance(
        std::min(speed_mps, drive_.max_forward_mps), drive_.reaction_s, braking_.deceleration_mps2);
    const double seen_m =
        now.local_map->seen_distance(now.T_odom_base, curvature, body_.half_width_m, longest_m);
    if (seen_m < longest_m) {
      speed_mps = std::min(speed_mps, stoppable_mps(seen_m));
    }
  }
  return {curvature, distance_m, speed_mps};
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
