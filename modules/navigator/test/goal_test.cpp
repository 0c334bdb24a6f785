// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/goal.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace goal_test {

TEST(Goal, ArrivesWithinToleranceAndStaysArrived) {
  const auto at = [](double distance_m) { return GoalInBase{{distance_m, 0}, 0.2}; };
  EXPECT_FALSE(has_arrived(at(0.21), false));
  EXPECT_TRUE(has_arrived(at(0.2), false));
  EXPECT_TRUE(has_arrived(at(0.25), true));
  EXPECT_FALSE(has_arrived(at(0.31), true));
}

}  // namespace goal_test
}  // namespace nodmap::navigator
