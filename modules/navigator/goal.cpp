// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/goal.hpp"

#include <cmath>

namespace nodmap::navigator {
namespace {

constexpr double kLeaveAgainM = 0.1;

}  // namespace

GoalInBase goal_in_base(const Eigen::Vector2d& p_goal_base, double tolerance_m) {
  return {std::atan2(p_goal_base.y(), p_goal_base.x()), p_goal_base.norm(), tolerance_m,
          p_goal_base, std::nullopt};
}

bool has_arrived(const GoalInBase& goal, bool had_arrived) {
  return goal.distance_m <= goal.tolerance_m + (had_arrived ? kLeaveAgainM : 0.0);
}

}  // namespace nodmap::navigator
