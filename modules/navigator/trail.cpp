// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/trail.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"
#include "common/geometry/pose_tolerance.hpp"
#include "modules/navigator/travel.hpp"

namespace nodmap::navigator {
namespace {

constexpr geometry::PoseTolerance kSpacing{.distance_m = 0.03,
                                           .rotation_rad = geometry::deg_to_rad(5.0)};
constexpr std::size_t kMaxPoses = 170;
// Distance back to the pose that the arc leads to: so short that the arc follows the trail.
constexpr double kLookBackM = 0.08;
// Up to this rotation from the heading of the trail the body stays on the strip that it has
// driven, within the margin it kept there.
constexpr double kMaxRotationRad = geometry::deg_to_rad(10.0);

}  // namespace

void Trail::move(const geometry::SE2& T_odom_base) {
  travel_m_ += here_ ? travel_m(*here_, T_odom_base) : 0.0;
  here_ = T_odom_base;
  while (!poses_.empty() && travel_m_ - poses_.front().travel_m > forget_after_m_) {
    poses_.pop_front();
  }
}

void Trail::record(const geometry::SE2& T_odom_base) {
  if (!poses_.empty() && geometry::is_within(poses_.back().T_odom_base, T_odom_base, kSpacing)) {
    return;
  }
  poses_.push_back({T_odom_base, travel_m_});
  if (poses_.size() > kMaxPoses) {
    poses_.pop_front();
  }
}

std::optional<Trail::PathBack> Trail::path_back(const geometry::SE2& T_odom_base) const {
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  const auto distance_m = [&T_base_odom](const Past& past) {
    return (T_base_odom * past.T_odom_base).translation().norm();
  };
  const auto past = std::find_if(poses_.rbegin(), poses_.rend(), [&](const Past& candidate) {
    return distance_m(candidate) >= kLookBackM;
  });
  if (past == poses_.rend() || distance_m(*past) > 2.0 * kLookBackM) {
    return std::nullopt;
  }
  const geometry::SE2 T_base_past = T_base_odom * past->T_odom_base;
  const double rotation_rad = std::atan2(-T_base_past.y, -T_base_past.x);
  if (std::abs(rotation_rad) > kMaxRotationRad) {
    return PathBack{rotation_rad, 0.0};
  }
  return PathBack{0.0, -T_base_past.yaw / distance_m(*past)};
}

double Trail::distance_backwards(const geometry::SE2& T_odom_base, double curvature) const {
  constexpr double kLongestM = 0.6;
  // Beside the strip the body keeps less than its margin, and its corners sweep 4 cm.
  constexpr double kAsideM = 0.05;
  constexpr double kObliqueHereRad = geometry::deg_to_rad(10.0);
  geometry::SE2 T_odom_back = T_odom_base;
  double distance_m = 0.0;
  while (distance_m < kLongestM) {
    T_odom_back =
        T_odom_back * geometry::SE2{-kSpacing.distance_m, 0.0, -kSpacing.distance_m * curvature};
    const bool was_here = std::ranges::any_of(poses_, [&](const Past& past) {
      const geometry::SE2& was = past.T_odom_base;
      return geometry::distance_m(was, T_odom_back) < kAsideM &&
             std::abs(geometry::angle_difference(was.yaw, T_odom_back.yaw)) < kObliqueHereRad;
    });
    if (!was_here) {
      break;
    }
    distance_m += kSpacing.distance_m;
  }
  return distance_m;
}

void Trail::forget_ahead(const geometry::SE2& T_odom_base) {
  while (!poses_.empty() && (T_odom_base.inverse() * poses_.back().T_odom_base).x > 0.01) {
    poses_.pop_back();
  }
}

}  // namespace nodmap::navigator
