// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/foresight.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

// Largest allowance for the error of a predicted place. The error grows beyond this, but by then
// the robot will have seen the person again.
constexpr double kMaxErrorM = 0.3;

}  // namespace

double distance_to_body(const Eigen::Vector2d& p_base, const robot::Footprint& body) {
  const double dx = std::abs(p_base.x()) - body.half_length_m;
  const double dy = std::abs(p_base.y()) - body.half_width_m;
  return dx > 0.0 && dy > 0.0 ? std::hypot(dx, dy) : std::max(dx, dy);
}

bool is_touched(const robot::Footprint& body, const geometry::SE2& pose_base, const Person& person,
                double time_s, double margin_m) {
  const double error_m =
      std::min(kMaxErrorM, std::hypot(person.position_sigma_m, person.velocity_sigma_mps * time_s));
  const double reach_m = person.radius_m + margin_m + error_m;
  const Eigen::Vector2d p_base = person.position_after(time_s);
  return (p_base - pose_base.translation()).norm() < reach_m + body.turning_radius_m() &&
         distance_to_body(pose_base.inverse() * p_base, body) < reach_m;
}

}  // namespace nodmap::navigator
