// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/back_up.hpp"

#include <algorithm>
#include <cmath>

#include "modules/navigator/travel.hpp"
#include "modules/navigator/turn.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kSpacingM = 0.03;
constexpr double kSpacingRad = geometry::deg_to_rad(5.0);
constexpr std::size_t kMaxPoses = 170;
/// Distance back to the pose that the arc leads to: so short that the arc follows the trail.
constexpr double kLookBackM = 0.08;
/// Up to this rotation from the heading of the trail the body stays on the strip that it has
/// driven, within the margin it kept there.
constexpr double kMaxRotationRad = geometry::deg_to_rad(10.0);
/// A shorter rotation back to the heading of the trail does not help.
constexpr double kLeastRotationRad = geometry::deg_to_rad(2.0);
/// Margin beside and behind the body over its own trail.
constexpr double kMarginM = 0.02;
/// With less than this beyond the margin the robot would not move.
constexpr double kLeastDistanceM = 0.01;
/// If the robot cannot rotate to the heading of its trail at all, as between people's feet, it
/// backs up straight, unless its heading is off by more than this. Over the 8 cm to the next pose
/// of the trail this leads 6 cm aside: as much as the clearance that it kept there.
constexpr double kObliqueRad = geometry::deg_to_rad(45.0);

bool is_near(const geometry::SE2& a, const geometry::SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < kSpacingM &&
         std::abs(geometry::angle_difference(a.yaw, b.yaw)) < kSpacingRad;
}

}  // namespace

void Trail::move(const geometry::SE2& T_odom_base) {
  travel_m_ += here_ ? travel_m(*here_, T_odom_base) : 0.0;
  here_ = T_odom_base;
  while (!poses_.empty() && travel_m_ - poses_.front().travel_m > forget_after_m_) {
    poses_.pop_front();
  }
}

void Trail::record(const geometry::SE2& T_odom_base) {
  if (!poses_.empty() && is_near(poses_.back().T_odom_base, T_odom_base)) {
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
    T_odom_back = T_odom_back * geometry::SE2{-kSpacingM, 0.0, -kSpacingM * curvature};
    const bool was_here = std::ranges::any_of(poses_, [&](const Past& past) {
      const geometry::SE2& was = past.T_odom_base;
      return std::hypot(was.x - T_odom_back.x, was.y - T_odom_back.y) < kAsideM &&
             std::abs(geometry::angle_difference(was.yaw, T_odom_back.yaw)) < kObliqueHereRad;
    });
    if (!was_here) {
      break;
    }
    distance_m += kSpacingM;
  }
  return distance_m;
}

void Trail::forget_ahead(const geometry::SE2& T_odom_base) {
  while (!poses_.empty() && (T_odom_base.inverse() * poses_.back().T_odom_base).x > 0.01) {
    poses_.pop_back();
  }
}

BackUp::BackUp(const NavigatorParams& params)
    : body_(params.robot.body.footprint()),
      braking_(params.robot.braking),
      reaction_s_(params.drive.reaction_s),
      turn_(params.turn),
      params_(params.back_up),
      trail_(params.local_map.forget_after_m) {}

void BackUp::record(const geometry::SE2& T_odom_base, double forward_mps) {
  trail_.move(T_odom_base);
  if (forward_mps < -kReversingMps) {
    trail_.forget_ahead(T_odom_base);
  } else if (!began_at_) {
    trail_.record(T_odom_base);
  }
}

bool BackUp::step(const Situation& now, Decision& decision) {
  if (!began_at_) {
    began_at_ = now.T_odom_base;
  }
  const auto path = trail_.path_back(now.T_odom_base);
  const double side = path ? std::copysign(1.0, path->rotation_rad) : 1.0;
  const double free_rad = free_rotation(now.points_base, side, body_, turn_.margin_m);
  const bool can_rotate = free_rad >= kLeastRotationRad;
  const double backed_up_m =
      std::hypot(began_at_->x - now.T_odom_base.x, began_at_->y - now.T_odom_base.y);
  if (!path || (!can_rotate && std::abs(path->rotation_rad) > kObliqueRad) ||
      backed_up_m >= params_.distance_m) {
    end();
    return false;
  }
  if (path->rotation_rad != 0.0 && can_rotate) {
    decision.yaw_rate_rad_s =
        side *
        yaw_rate_on_the_spot(std::min(std::abs(path->rotation_rad), free_rad), turn_, reaction_s_);
    return true;
  }
  trail_.forget_ahead(now.T_odom_base);
  const double distance_m =
      free_distance_backwards(now.points_base, path->curvature, body_, kMarginM) - kMarginM;
  if (distance_m < kLeastDistanceM) {
    end();
    return false;
  }
  decision.forward_mps =
      -std::min(params_.speed_mps,
                robot::stoppable_speed(distance_m, reaction_s_, braking_.deceleration_mps2));
  decision.yaw_rate_rad_s = decision.forward_mps * path->curvature;
  return true;
}

}  // namespace nodmap::navigator
