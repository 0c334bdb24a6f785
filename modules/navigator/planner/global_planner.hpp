// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/cost_to_go.hpp"
#include "modules/navigator/planner/distance_field.hpp"
#include "modules/navigator/planner/known_ground.hpp"
#include "modules/navigator/planner/plan_window.hpp"
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

 private:
  enum class Phase : std::uint8_t { kIdle, kOccupy, kMeasureDistances, kPrice, kSearch };
  /// What a plan takes as passable; if it leaves no path, the next one is tried. Tight: to a goal
  /// only occupied cells block, without a goal the path is shorter.
  enum class Attempt : std::uint8_t { kUsual, kTight, kWithoutMap, kTightWithoutMap };

  void take_new_goal();
  [[nodiscard]] bool start_if_due(time::Timestamp stamp);
  void go_on(const Eigen::Vector2d& p_map, const Geofence* geofence);
  void begin(const PlanWindow& window);
  [[nodiscard]] int prepare_line(const Geofence* geofence);
  void occupy_row(int row);
  void occupy_boundary(const Geofence& geofence);
  void begin_search();
  void price_row(int row);
  [[nodiscard]] bool is_tight() const {
    return attempt_ == Attempt::kTight || attempt_ == Attempt::kTightWithoutMap;
  }
  [[nodiscard]] bool uses_map() const {
    return map_2d_ != nullptr && (attempt_ == Attempt::kUsual || attempt_ == Attempt::kTight);
  }
  [[nodiscard]] bool try_next();
  void read_map_row(const Eigen::Vector2i& first);
  void price_failures();
  void finish(const Eigen::Vector2d& p_map);

  robot::Footprint body_;
  PlannerParams params_;
  KnownGround ground_;
  std::deque<Eigen::Vector2d> failures_map_;  // the oldest first

  Phase phase_ = Phase::kIdle;
  int row_ = 0;  // the next one to be occupied or priced
  Attempt attempt_ = Attempt::kUsual;
  const Map2d* map_2d_ = nullptr;     // of this step; null: none
  std::vector<Map2d::Kind> map_row_;  // of the row being occupied or priced
  std::optional<time::Timestamp> started_at_;
  Eigen::Vector2d goal_map_ = Eigen::Vector2d::Zero();  // of the last plan that was begun
  double tolerance_m_ = 0.0;                            // the same
  bool goal_is_new_ = false;                            // since that plan was begun
  std::optional<geometry::SE2> onward_from_;            // T_map_base; empty: to the goal
  PlanWindow window_;
  DistanceField obstacle_distances_;
  std::vector<float> price_;  // of a metre of path, by cell; negative: blocked
  CostSearch search_;
  std::optional<CostToGo> complete_;
  time::Timestamp completed_from_{};  // when the plan that is complete was begun
  bool is_former_ = false;            // complete_ is the plan to a previous goal
};

}  // namespace nodmap::navigator
