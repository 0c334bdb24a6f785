// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/se2.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/global_planner.hpp"
#include "modules/navigator/planner/local_planner.hpp"
#include "modules/navigator/planner/patience.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// Drives without a goal: the local planner drives the rollout that is the best by the cost of
/// getting 3.5 m away, cheapest ahead. If the robot makes no progress, the plan must be wrong about
/// what is ahead, so the next plans lead elsewhere.
class Roaming {
 public:
  explicit Roaming(const NavigatorParams& params);

  /// Returns the decision; empty if no motion is possible, so that Turn takes over. `now` must have
  /// a local map.
  [[nodiscard]] std::optional<Decision> decide(const Situation& now);

  /// The frame map is another one from now on: forgets what it knows of places in map.
  void forget_map();

 private:
  void watch_progress(const Situation& now);
  void give_up_path(const geometry::SE2& T_map_base);

  GlobalPlanner global_planner_;
  LocalPlanner local_planner_;
  Patience patience_;
  geometry::SE2 progress_odom_;               // T_odom_base at the last progress
  std::optional<Eigen::Vector2d> failed_at_;  // map; paths ahead of this place cost more
};

}  // namespace nodmap::navigator
