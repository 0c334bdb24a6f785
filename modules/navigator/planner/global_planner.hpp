// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/cost_to_go.hpp"
#include "modules/navigator/planner/far_plan.hpp"
#include "modules/navigator/planner/ground_plan.hpp"
#include "modules/navigator/planner/known_ground.hpp"
#include "modules/navigator/planner/map_2d.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// Plans to the goal on all the ground that the local map has shown and, where it has shown none,
/// on the 2D map. Unknown ground can be crossed at a price. The work is done in small portions, so
/// that no decision waits for it.
///
/// The robot's centre stays half the body's width away from blocked cells. A cell with less than
/// the least clearance costs much more; with a little more clearance it still costs a little more.
/// Where the robot cannot turn, or where a place is narrower than the grid shows, the local planner
/// finds out; a narrow place in which the robot could not go on is closed.
///
/// The plan covers a window around the robot. If more than that is known, or the goal is farther
/// away, a plan of all ground (FarPlan) says what it costs to go on from the window's border. So a
/// dead end that is longer than the window is remembered, and the robot does not return into it.
///
/// The 2D map may show a door closed that is open by now. If it leaves no path, the plan is made
/// without it: there is a path to every goal to which there would be one without a 2D map.
class GlobalPlanner {
 public:
  GlobalPlanner(const robot::Footprint& body, const PlannerParams& params);

  /// Does one portion of work; starts a new plan every `replan_s`. No path crosses the boundary of
  /// the geofence. `now` must have a goal and a local map.
  void step(const Situation& now);

  /// The same without a goal: plans to where the robot can go on, 3.5 m away in any direction,
  /// cheapest ahead. Use one planner either for goals or for this.
  void step_onward(const Situation& now);

  /// Null before the first plan to this goal is complete. If the goal changes by less than half of
  /// its tolerance, the next plan leads to where it is then.
  [[nodiscard]] const CostToGo* cost_to_go() const {
    return complete_ && !is_former_ ? &*complete_ : nullptr;
  }
  /// The plan to a previous goal, until there is one to this goal; null if it is not recent.
  [[nodiscard]] const CostToGo* former_cost_to_go() const {
    return complete_ && is_former_ ? &*complete_ : nullptr;
  }

  /// Adds a place where the robot could not go on: paths through it cost more from now on, until 50
  /// more have been added.
  void add_failure(const Eigen::Vector2d& p_map);
  /// The same for a place on the plan, 0.4 m ahead of the robot, which is at `p_map`.
  void give_up_path_from(const Eigen::Vector2d& p_map);
  void forget_failures() { failures_map_.clear(); }

  /// Forgets all ground; the next plan uses only what the local map holds.
  void forget_ground();
  /// The frame map is another one from now on: forgets the plan and the failures as well.
  void forget_map();

 private:
  void take_new_goal();
  [[nodiscard]] bool start_if_due(time::Timestamp stamp);
  void begin(const Situation& now);
  void advance_far_plan(const Situation& now);
  void advance(const Situation& now);
  [[nodiscard]] PlanBasis basis(const Situation& now) const;

  PlannerParams params_;
  KnownGround ground_;
  std::deque<Eigen::Vector2d> failures_map_;  // the oldest first

  const Map2d* map_2d_ = nullptr;  // of this step; null: none
  std::optional<time::Timestamp> started_at_;
  FarPlan::Goal goal_;                        // of the last plan that was begun
  bool goal_is_new_ = false;                  // since that plan was begun
  std::optional<geometry::SE2> onward_from_;  // T_map_base; empty: to the goal
  GroundPlan plan_;
  std::optional<CostToGo> complete_;
  time::Timestamp completed_from_{};  // when the plan that is complete was begun
  bool is_former_ = false;            // complete_ is the plan to a previous goal
  FarPlan far_plan_;
};

}  // namespace nodmap::navigator
