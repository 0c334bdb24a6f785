// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/global_planner.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

// About 0.5 ms of search. While a search is prepared each cell is visited five times. So many
// visits take about 4 ms: a window of 22 m x 22 m is prepared at once, one of 51 m x 51 m in six
// portions.
constexpr GroundPlan::Portion kPortion{.prepared = 1'000'000, .searched = 8000};
// The same with 2 ms of search, while the robot has no plan to its goal, and waits or drives by an
// old one.
constexpr GroundPlan::Portion kFirstPortion{.prepared = 1'000'000, .searched = 32'000};
// In addition, beyond the window, where nothing is urgent: 0.25 ms of search or 0.8 ms before it.
constexpr GroundPlan::Portion kPortionBeyond{.prepared = 200'000, .searched = 4000};
// So many places where the robot could not go on are remembered: with each it has made no progress
// for some seconds.
constexpr std::size_t kMaxFailures = 50;
// A plan older than this is not used any more, because the ground may have changed.
constexpr double kRecentS = 2.0;
// A plan onward is dropped when the robot is farther than this from where it was made. From one
// plan to the next it drives 0.9 m at 1.5 m/s.
constexpr double kLeftM = 1.75;

}  // namespace

GlobalPlanner::GlobalPlanner(const robot::Footprint& body, const PlannerParams& params)
    : params_(params), plan_(body, params), far_plan_(body, params) {}

void GlobalPlanner::add_failure(const Eigen::Vector2d& p_map) {
  if (failures_map_.size() == kMaxFailures) {
    failures_map_.pop_front();
  }
  failures_map_.push_back(p_map);
}

void GlobalPlanner::give_up_path_from(const Eigen::Vector2d& p_map) {
  constexpr double kGiveUpAheadM = 0.4;
  add_failure(complete_->path_from(p_map, kGiveUpAheadM).back());
}

void GlobalPlanner::forget_ground() {
  ground_.forget();
  started_at_.reset();
  plan_.stop();
  far_plan_.forget();
}

void GlobalPlanner::forget_map() {
  forget_ground();
  forget_failures();
  complete_.reset();
  is_former_ = false;
}

void GlobalPlanner::step(const Situation& now) {
  const geometry::SE2 T_map_base = now.T_map_base();
  const Eigen::Vector2d goal_map = T_map_base * now.goal->p_base;
  const double tolerance_m = now.goal->tolerance_m;
  map_2d_ = now.map_2d != nullptr && !now.map_2d->is_empty() ? now.map_2d : nullptr;
  goal_is_new_ =
      (goal_map - goal_.p_map).norm() > 0.5 * tolerance_m || tolerance_m != goal_.tolerance_m;
  if (goal_is_new_) {
    take_new_goal();
  }
  if (is_former_ && time::seconds(std::chrono::abs(now.stamp - completed_from_)) > kRecentS) {
    is_former_ = false;
    complete_.reset();
  }
  advance_far_plan(now);
  if (plan_.is_active()) {
    advance(now);
  } else if (start_if_due(now.stamp)) {
    goal_ = {goal_map, tolerance_m};
    goal_is_new_ = false;
    begin(now);
  }
}

// The present plan becomes the former one, and the next begins at once. If the goal has changed
// again before there is a plan to it, that plan is completed first: otherwise there would be none
// while the goal moves.
void GlobalPlanner::take_new_goal() {
  failures_map_.clear();
  if (cost_to_go() != nullptr) {
    is_former_ = true;
    plan_.stop();
    far_plan_.stop();
  }
  if (!plan_.is_active()) {
    started_at_.reset();
  }
}

void GlobalPlanner::step_onward(const Situation& now) {
  const geometry::SE2 T_map_base = now.T_map_base();
  // The last plan onward may have been made elsewhere, before the robot drove to a goal.
  if (onward_from_ && (T_map_base.translation() - onward_from_->translation()).norm() > kLeftM) {
    complete_.reset();
    plan_.stop();
  }
  if (plan_.is_active()) {
    advance(now);
  } else if (start_if_due(now.stamp)) {
    ground_.update(now);
    plan_.begin_onward(ground_.window_within(T_map_base.translation(),
                                             GroundPlan::kOnwardM + 2.0 * KnownGround::kCellM),
                       T_map_base);
    onward_from_ = T_map_base;
  }
}

// Starts the time to the next plan, if the last one began long enough ago.
bool GlobalPlanner::start_if_due(time::Timestamp stamp) {
  if (started_at_ && time::seconds(std::chrono::abs(stamp - *started_at_)) < params_.replan_s) {
    return false;
  }
  started_at_ = stamp;
  return true;
}

// Begins a plan to the goal. A plan to a goal outside of the window waits for the first plan of all
// ground: on a straight line the robot could set off the wrong way.
void GlobalPlanner::begin(const Situation& now) {
  const Eigen::Vector2d p_map = now.T_map_base().translation();
  ground_.update(now);
  far_plan_.begin_if_due(now.stamp, basis(now), p_map, goal_);
  const PlanWindow window = ground_.window_around(p_map, goal_.p_map, map_2d_);
  const Eigen::Vector2i goal = window.cell_of(goal_.p_map);
  if (window.contains(goal.x(), goal.y()) || !far_plan_.is_coming(goal_)) {
    plan_.begin(window, goal_.p_map, goal_.tolerance_m);
  }
}

// It waits while the plan in the window is prepared, which takes as long as a decision may wait.
void GlobalPlanner::advance_far_plan(const Situation& now) {
  if (!far_plan_.is_active() || plan_.is_preparing()) {
    return;
  }
  const bool is_waited_for = cost_to_go() == nullptr && !plan_.is_active();
  if (far_plan_.advance(basis(now), now.T_map_base().translation(),
                        is_waited_for ? kFirstPortion : kPortionBeyond) &&
      is_waited_for) {
    started_at_.reset();
  }
}

PlanBasis GlobalPlanner::basis(const Situation& now) const {
  return {.ground = ground_,
          .map_2d = map_2d_,
          .geofence = now.geofence,
          .failures_map = failures_map_,
          .beyond = far_plan_.to(goal_),
          .waits_for_beyond = far_plan_.is_coming(goal_)};
}

// While the plan of all ground is coming, a plan without a path is dropped: a path may lead out of
// the window.
void GlobalPlanner::advance(const Situation& now) {
  const Eigen::Vector2d p_map = now.T_map_base().translation();
  const bool is_first = cost_to_go() == nullptr;
  if (!plan_.advance(basis(now), p_map, is_first ? kFirstPortion : kPortion)) {
    return;
  }
  if (far_plan_.is_coming(goal_) && !std::isfinite(plan_.found().least_near(p_map))) {
    return;
  }
  plan_.exchange_found(complete_ ? *complete_ : complete_.emplace());
  completed_from_ = *started_at_;
  is_former_ = goal_is_new_;
}

}  // namespace nodmap::navigator
