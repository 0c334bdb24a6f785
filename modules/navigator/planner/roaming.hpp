// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/brake.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/global_planner.hpp"
#include "modules/navigator/planner/rollouts.hpp"
#include "modules/navigator/planner/safe_motion.hpp"
#include "modules/navigator/seen_directions.hpp"

namespace nodmap::navigator {

/// Drives without a goal: the rollouts are rated by the cost of getting 3.5 m away, cheapest ahead,
/// and Brake, which does not use that cost, finally limits the speed of the best. If the robot
/// makes no progress, the plan is wrong about what is ahead and leads elsewhere from then on.
class Roaming {
 public:
  explicit Roaming(const NavigatorParams& params);

  /// Returns the decision; empty if no motion is possible, so that Turn takes over.
  [[nodiscard]] std::optional<Decision> decide(const Situation& now, const SeenDirections& seen,
                                               const LocalMap& local_map);

 private:
  [[nodiscard]] bool is_stuck(const Situation& now);
  void give_up_path(const geometry::SE2& T_map_base);

  Brake brake_;
  GlobalPlanner planner_;
  Rollouts rollouts_;
  SafeMotion motion_;
  std::optional<time::Timestamp> decided_at_;
  time::Timestamp progress_at_{};
  geometry::SE2 progress_odom_;               // T_odom_base then
  std::optional<Eigen::Vector2d> failed_at_;  // map; since then paths ahead of it cost more
};

}  // namespace nodmap::navigator
