// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/roaming.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

// Cost of backing up. Without a goal the robot need not get to any place behind it, and backing up
// at 0.15 m/s takes longer than any rotation.
constexpr double kReversePriceM = 1.0;

// What counts as progress, and for how long the robot may make none. A rotation by 180 degrees
// takes three seconds.
constexpr double kFartherM = 0.2;
constexpr double kRotatedRad = 0.7;
constexpr time::Duration kRoamingPatience = 3s;
// A path is given up until the robot is this far away.
constexpr double kElsewhereM = 3.0;

NavigatorParams roaming(NavigatorParams params) {
  params.planner.reverse_price = std::max(params.planner.reverse_price, kReversePriceM);
  return params;
}

}  // namespace

Roaming::Roaming(const NavigatorParams& params)
    : global_planner_(params.robot.body.footprint(), params.planner),
      local_planner_(roaming(params), false),
      patience_(kRoamingPatience) {}

std::optional<Decision> Roaming::decide(const Situation& now) {
  global_planner_.step_onward(now);
  const CostToGo* cost_to_go = global_planner_.cost_to_go();
  if (cost_to_go == nullptr) {
    return local_planner_.slow_down(Why::kPlans, now);
  }
  const geometry::SE2 T_map_base = now.T_map_base();
  if (!std::isfinite(cost_to_go->least_near(T_map_base.translation()))) {
    return std::nullopt;
  }
  watch_progress(now);
  if (patience_.is_over(now.stamp)) {
    give_up_path(T_map_base);
  } else if (failed_at_ && (T_map_base.translation() - *failed_at_).norm() > kElsewhereM) {
    global_planner_.forget_failures();
    failed_at_.reset();
  }
  return local_planner_.drive_best(now, *cost_to_go);
}

void Roaming::forget_map() {
  global_planner_.forget_map();
  failed_at_.reset();
}

// Progress is to get farther, or to rotate. Time in which the robot waited for people, or in which
// others decided, counts as progress.
void Roaming::watch_progress(const Situation& now) {
  patience_.record(now.stamp);
  const geometry::SE2 moved = progress_odom_.inverse() * now.T_odom_base;
  if (!patience_.has_begun() || !now.people.empty() || moved.translation().norm() > kFartherM ||
      std::abs(moved.yaw) > kRotatedRad) {
    patience_.restart(now.stamp);
    progress_odom_ = now.T_odom_base;
  }
}

void Roaming::give_up_path(const geometry::SE2& T_map_base) {
  failed_at_ = T_map_base.translation();
  global_planner_.give_up_path_from(*failed_at_);
  patience_.end();
}

}  // namespace nodmap::navigator
