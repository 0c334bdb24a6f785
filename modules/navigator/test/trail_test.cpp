// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/trail.hpp"

#include <gtest/gtest.h>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace trail_test {

using geometry::deg_to_rad;

TEST(Trail, LeadsBackAlongThePathOfTheRobot) {
  Trail trail(20.0);
  EXPECT_FALSE(trail.path_back({}));
  geometry::SE2 pose;
  for (int i = 0; i < 50; ++i) {  // half a metre on an arc of 1 m to the left
    trail.record(pose);
    pose = pose * geometry::SE2{0.01, 0, 0.01};
  }
  const auto back = trail.path_back(pose);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->rotation_rad, 0.0);
  EXPECT_NEAR(back->curvature, 1.0, 0.02);  // each step is a chord of the arc
}

TEST(Trail, BackwardsTheBodyStaysWhereItHasBeen) {
  Trail trail(20.0);
  for (int i = 0; i <= 30; ++i) {
    trail.record({0.01 * i, 0.0, 0.0});  // 0.3 m straight ahead
  }
  // The body may move back to 5 cm behind its first pose; the distance is found in steps of 3 cm.
  EXPECT_NEAR(trail.distance_backwards({0.3, 0.0, 0.0}, 0.0), 0.33, 0.031);
  // On a radius of 0.2 m the heading has changed by 10 degrees after 3.5 cm.
  EXPECT_LE(trail.distance_backwards({0.3, 0.0, 0.0}, 5.0), 0.05);
  // Once the robot has rotated by 90 degrees, it has not been behind itself.
  for (int i = 0; i <= 18; ++i) {
    trail.record({0.3, 0.0, deg_to_rad(5.0 * i)});
  }
  EXPECT_LE(trail.distance_backwards({0.3, 0.0, deg_to_rad(90.0)}, 0.0), 0.05);
  EXPECT_EQ(Trail(20.0).distance_backwards({}, 0.0), 0.0);
}

TEST(Trail, ThePathBackBeginsWithARotationToTheHeadingOfTheWayIn) {
  Trail trail(20.0);
  for (int i = 0; i <= 10; ++i) {
    trail.record({0.05 * i, 0, 0});
  }
  const auto back = trail.path_back({0.5, 0, deg_to_rad(60)});
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->rotation_rad, deg_to_rad(-60), 1e-9);
}

TEST(Trail, ThereIsNoPathBackAtTheStartOfTheTrailOrFarFromIt) {
  Trail trail(20.0);
  trail.record({0, 0, 0});
  EXPECT_FALSE(trail.path_back({0.02, 0, 0}));
  EXPECT_FALSE(trail.path_back({1.0, 0, 0}));
  trail.record({0.1, 0, 0});
  trail.forget_ahead({0.05, 0, 0});
  EXPECT_FALSE(trail.path_back({0.05, 0, 0}));
}

// Odometry drifts: after much travel the way driven is not where odometry says, however short it
// is.
TEST(Trail, IsForgottenAfterMuchTravel) {
  Trail trail(20.0);
  const geometry::SE2 end{0.5, 0.0, 0.0};
  for (int i = 0; i <= 50; ++i) {
    trail.move({0.01 * i, 0.0, 0.0});
    trail.record({0.01 * i, 0.0, 0.0});
  }
  const double strip_m = trail.distance_backwards(end, 0.0);
  EXPECT_NEAR(strip_m, 0.53, 0.031);  // as above
  // To and fro on the spot: each round counts as 8 m of travel.
  for (int turns = 1; turns <= 3; ++turns) {
    trail.move({0.5, 0.0, 1.0});
    trail.move(end);
    EXPECT_EQ(trail.distance_backwards(end, 0.0), turns < 3 ? strip_m : 0.0) << turns;
    EXPECT_EQ(trail.path_back(end).has_value(), turns < 3) << turns;
  }
}

}  // namespace trail_test
}  // namespace nodmap::navigator
