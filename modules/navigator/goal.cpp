// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/goal.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kLeaveAgainM = 0.1;

}  // namespace

bool has_arrived(const GoalInBase& goal, bool had_arrived) {
  return goal.distance_m() <= goal.tolerance_m + (had_arrived ? kLeaveAgainM : 0.0);
}

}  // namespace nodmap::navigator
