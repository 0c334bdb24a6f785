// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "modules/navigator/behaviours/free_space.hpp"
#include "modules/navigator/behaviours/side.hpp"
#include "modules/navigator/goal.hpp"

namespace nodmap::navigator {

/// Leads around an obstacle between robot and goal (after Bug2, Lumelsky and Stepanov 1987): along
/// the wall, on the side first chosen, until the direction to the goal is free and the goal is
/// nearer than where the detour began. Without this memory the robot would leave a dead end and
/// drive into it again.
class Detour {
 public:
  /// The direction to steer to, in base; empty if no direction ahead is free for `needed_m`.
  [[nodiscard]] std::optional<double> direction(const FreeSpace& space, const Points& points_base,
                                                const GoalInBase& goal, double needed_m);

  /// The side of the detour.
  [[nodiscard]] Side side() const { return side_; }
  /// Begins a detour, because the robot had to turn to this side, away from an obstacle.
  void begin(Side side, const GoalInBase& goal);
  void end() { side_ = Side::kNone; }

 private:
  [[nodiscard]] std::optional<double> round_obstacle(const FreeSpace& space, const GoalInBase& goal,
                                                     double straight_rad, double needed_m);

  Side side_ = Side::kNone;
  double began_at_m_ = 0.0;  // distance to the goal
};

}  // namespace nodmap::navigator
