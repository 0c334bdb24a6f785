// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/trail.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

constexpr double kSpacingM = 0.03;
constexpr double kSpacingRad = geometry::deg_to_rad(5.0);
constexpr std::size_t kMaxPoses = 170;
/// How far back the pose lies that the arc leads to: near enough for the arc to be the trail.
constexpr double kLookBackM = 0.08;
/// Within this the body stays on the strip it has driven, up to the margin it kept there.
constexpr double kMaxTurnRad = geometry::deg_to_rad(10.0);

bool is_near(const geometry::SE2& a, const geometry::SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < kSpacingM &&
         std::abs(geometry::angle_difference(a.yaw, b.yaw)) < kSpacingRad;
}

}  // namespace

void Trail::record(const geometry::SE2& T_odom_base) {
  if (!poses_.empty() && is_near(poses_.back(), T_odom_base)) {
    return;
  }
  poses_.push_back(T_odom_base);
  if (poses_.size() > kMaxPoses) {
    poses_.pop_front();
  }
}

std::optional<Trail::WayBack> Trail::way_back(const geometry::SE2& T_odom_base) const {
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  const auto distance_m = [&T_base_odom](const geometry::SE2& T_odom_past) {
    return (T_base_odom * T_odom_past).translation().norm();
  };
  const auto past = std::find_if(
      poses_.rbegin(), poses_.rend(),
      [&](const geometry::SE2& T_odom_past) { return distance_m(T_odom_past) >= kLookBackM; });
  if (past == poses_.rend() || distance_m(*past) > 2.0 * kLookBackM) {
    return std::nullopt;
  }
  const geometry::SE2 T_base_past = T_base_odom * *past;
  const double turn_rad = std::atan2(-T_base_past.y, -T_base_past.x);
  if (std::abs(turn_rad) > kMaxTurnRad) {
    return WayBack{turn_rad, 0.0};
  }
  return WayBack{0.0, -T_base_past.yaw / distance_m(*past)};
}

void Trail::retreat(const geometry::SE2& T_odom_base) {
  while (!poses_.empty() && (T_odom_base.inverse() * poses_.back()).x > 0.01) {
    poses_.pop_back();
  }
}

}  // namespace nodmap::navigator
