// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/time.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/cost_to_go.hpp"
#include "modules/navigator/planner/ground_plan.hpp"

namespace nodmap::navigator {

/// The plan of all ground, for goals and ways round beyond the window that the usual plan covers.
/// It is made anew every five seconds, in portions, and is coarser than the usual plan if the
/// ground is large.
class FarPlan {
 public:
  /// Plans to goals within each other's tolerance are as good as each other.
  struct Goal {
    Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
    double tolerance_m = 0.0;
  };

  FarPlan(const robot::Footprint& body, const PlannerParams& params) : plan_(body, params) {}

  /// Begins a plan from `p_map`, if the usual window leaves something out and the last plan began
  /// long enough ago or leads to another goal. A plan in progress that leads to another goal is
  /// given up, but not two in succession: otherwise there would be none while the goal moves.
  void begin_if_due(time::Timestamp stamp, const PlanBasis& basis, const Eigen::Vector2d& p_map,
                    const Goal& goal);

  /// Whether a plan is in progress.
  [[nodiscard]] bool is_active() const { return plan_.is_active(); }
  /// Continues it for the robot at `p_map`. Returns true when it is complete.
  [[nodiscard]] bool advance(const PlanBasis& basis, const Eigen::Vector2d& p_map,
                             const GroundPlan::Portion& portion);

  /// The plan to this goal; null if none is complete.
  [[nodiscard]] const CostToGo* to(const Goal& goal) const;
  /// Whether the first plan to this goal is in progress.
  [[nodiscard]] bool is_coming(const Goal& goal) const;

  /// Gives up the plan in progress.
  void stop() { plan_.stop(); }
  /// Forgets the plan that is complete as well.
  void forget();

 private:
  GroundPlan plan_;
  std::optional<time::Timestamp> began_at_;
  Eigen::Vector2d goal_map_ = Eigen::Vector2d::Zero();  // of the last plan that was begun
  bool has_given_up_ = false;                           // the plan before that one
  std::optional<CostToGo> complete_;
  Eigen::Vector2d complete_goal_map_ = Eigen::Vector2d::Zero();
};

}  // namespace nodmap::navigator
