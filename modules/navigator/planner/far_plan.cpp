// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/far_plan.hpp"

#include "modules/navigator/planner/known_ground.hpp"

namespace nodmap::navigator {
namespace {

// What the plan bears on lies beyond the window, 25 m away, of which the robot drives a third in
// this time.
constexpr double kReplanFarS = 5.0;

bool leads_to(const FarPlan::Goal& goal, const Eigen::Vector2d& goal_map) {
  return (goal_map - goal.p_map).norm() <= goal.tolerance_m;
}

}  // namespace

void FarPlan::begin_if_due(time::Timestamp stamp, const PlanBasis& basis,
                           const Eigen::Vector2d& p_map, const Goal& goal) {
  const bool is_to_goal = leads_to(goal, goal_map_);
  if (plan_.is_active() && (is_to_goal || has_given_up_)) {
    return;
  }
  if (began_at_ && is_to_goal &&
      time::seconds(std::chrono::abs(stamp - *began_at_)) < kReplanFarS) {
    return;
  }
  has_given_up_ = plan_.is_active();
  plan_.stop();
  began_at_ = stamp;
  goal_map_ = goal.p_map;
  if (const auto window = basis.ground.window_of_all(p_map, goal.p_map, basis.map_2d)) {
    plan_.begin(*window, goal.p_map, goal.tolerance_m);
  } else {
    complete_.reset();
  }
}

bool FarPlan::advance(const PlanBasis& basis, const Eigen::Vector2d& p_map,
                      const GroundPlan::Portion& portion) {
  PlanBasis all = basis;
  all.beyond = nullptr;
  all.waits_for_beyond = false;
  if (!plan_.advance(all, p_map, portion)) {
    return false;
  }
  plan_.exchange_found(complete_ ? *complete_ : complete_.emplace());
  complete_goal_map_ = goal_map_;
  has_given_up_ = false;
  return true;
}

const CostToGo* FarPlan::to(const Goal& goal) const {
  return complete_ && leads_to(goal, complete_goal_map_) ? &*complete_ : nullptr;
}

bool FarPlan::is_coming(const Goal& goal) const {
  return to(goal) == nullptr && plan_.is_active() && leads_to(goal, goal_map_);
}

void FarPlan::forget() {
  plan_.stop();
  began_at_.reset();
  has_given_up_ = false;
  complete_.reset();
}

}  // namespace nodmap::navigator
