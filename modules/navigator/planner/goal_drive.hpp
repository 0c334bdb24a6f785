// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/back_out.hpp"
#include "modules/navigator/planner/docking.hpp"
#include "modules/navigator/planner/global_planner.hpp"
#include "modules/navigator/planner/local_planner.hpp"
#include "modules/navigator/planner/look_around.hpp"
#include "modules/navigator/planner/path_progress.hpp"
#include "modules/navigator/planner/patience.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// Drives to a goal by plan: the global planner computes the cost of each place, and the local
/// planner drives the rollout that is the best by this cost. At a goal with a heading the robot
/// docks (docking.hpp); the local planner makes those motions safe as well.
///
/// A decision is that of drive_by_plan() or, at a goal with a heading, of dock(), which leaves the
/// path to the staging place to drive_by_plan(). That plans, and goes on with drive_by() or
/// without_path(). drive_by() backs out or calls drive_or_stay(): the best rollout, otherwise
/// squeeze(), otherwise stay().
class GoalDrive {
 public:
  explicit GoalDrive(const NavigatorParams& params);

  /// The robot has no goal any more: the same dock is then approached from the beginning.
  void forget_goal() {
    dock_map_.reset();
    decided_goal_map_.reset();
  }

  /// The frame map is another one from now on: forgets what it knows of places in map.
  void forget_map();

  /// Paths to the present goal cost more near this place from now on.
  void avoid(const Eigen::Vector2d& p_map) { global_planner_.add_failure(p_map); }

  /// `now` must have a goal and a local map.
  [[nodiscard]] Decision decide(const Situation& now);

  /// The planned path from the robot to a goal, frame map, a point every 20 cm, as far as the grid
  /// reaches. It has no points if there is no path, the robot cannot move or docking has failed;
  /// empty before the first plan to this goal is complete. The yaw of a goal without a heading is
  /// 0.
  [[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> path_map(
      const geometry::SE2& T_map_base, const geometry::SE2& T_map_goal) const;

 private:
  [[nodiscard]] Decision drive_by_plan(const Situation& now);
  [[nodiscard]] Decision dock(const Situation& now);
  [[nodiscard]] const CostToGo* former_plan(const Eigen::Vector2d& p_map) const;
  [[nodiscard]] Decision drive_by(const CostToGo& cost_to_go, const Situation& now);
  [[nodiscard]] Decision drive_or_stay(const CostToGo& cost_to_go, const Situation& now);
  [[nodiscard]] Decision stay(const Situation& now);
  [[nodiscard]] std::optional<Decision> squeeze(const CostToGo& cost_to_go, const Situation& now);
  [[nodiscard]] Decision without_path(const Situation& now);
  void watch_progress(const Situation& now, double cost_m);

  NavigatorParams params_;
  GlobalPlanner global_planner_;
  LocalPlanner local_planner_;
  LocalPlanner squeezing_planner_;
  BackOut back_out_;
  Docking docking_;
  std::optional<geometry::SE2> dock_map_;
  std::optional<geometry::SE2> decided_goal_map_;  // of the last decision to drive to a goal
  Eigen::Vector2d goal_map_ = Eigen::Vector2d::Zero();
  PathProgress path_progress_;
  Patience without_motion_;   // since any could last be driven
  bool cannot_move_ = false;  // and that for longer than its patience
  LookAround look_around_;
};

}  // namespace nodmap::navigator
