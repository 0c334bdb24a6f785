// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/detour.hpp"

#include <gtest/gtest.h>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace detour_test {

using geometry::deg_to_rad;

TEST(Detour, BeginsAtAnObstacleAndEndsNearerToTheGoal) {
  FreeSpace space;
  space.distance_m.fill(5.0);
  Detour detour;
  EXPECT_EQ(detour.direction(space, {}, GoalInBase{{3, 0}, 0.2}, 1.0), 0.0);
  for (int degree = -40; degree <= 30; ++degree) {
    space.at(degree) = 0.6;
  }
  EXPECT_EQ(detour.direction(space, {}, GoalInBase{{3, 0}, 0.2}, 1.0), deg_to_rad(31));
  EXPECT_EQ(detour.side(), Side::kLeft);
  // The way is free again, but the robot is no nearer to the goal: it follows the wall on the
  // right.
  space.distance_m.fill(5.0);
  const Points wall{{0.3, -0.5}};
  const auto along = detour.direction(space, wall, GoalInBase{{3.5, 0}, 0.2}, 1.0);
  ASSERT_TRUE(along);
  EXPECT_LT(*along, 0.0);
  EXPECT_EQ(detour.side(), Side::kLeft);
  EXPECT_EQ(detour.direction(space, wall, GoalInBase{{2.5, 0}, 0.2}, 1.0), 0.0);
  EXPECT_EQ(detour.side(), Side::kNone);
}

TEST(Detour, AnObstacleBeyondTheGoalDoesNotBlockThePath) {
  FreeSpace space;
  space.distance_m.fill(0.6);
  Detour detour;
  EXPECT_EQ(detour.direction(space, {}, GoalInBase{{0.5, 0}, 0.1}, 1.0), 0.0);
}

}  // namespace detour_test
}  // namespace nodmap::navigator
