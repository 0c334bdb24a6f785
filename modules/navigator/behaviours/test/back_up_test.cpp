// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/back_up.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace back_up_test {

// After half a metre straight ahead.
struct BackUpTest : testing::Test {
  BackUpTest() {
    for (int i = 0; i <= 50; ++i) {
      back_up.record({0.01 * i, 0.0, 0.0}, 0.5);
    }
    now.T_odom_base = {0.5, 0.0, 0.0};
  }

  NavigatorParams params;
  BackUp back_up{params};
  Brake brake{params};
  Situation now;
};

TEST_F(BackUpTest, EndsBeforeWhatIsBehind) {
  const double rear_m = params.robot.body.footprint().half_length_m;
  now.points_base = {{-rear_m - 0.3, 0.0}};
  const auto motion = back_up.step(now, brake);
  ASSERT_TRUE(motion);
  EXPECT_LT(motion->forward_mps, -0.05);
  now.points_base = {{-rear_m - 0.02, 0.0}};
  EXPECT_FALSE(back_up.step(now, brake));
}

// The plan has reversed 20 cm. What is ahead now is not the way back.
TEST_F(BackUpTest, ThePathBackIsBehindARobotThatHasReversedByPlan) {
  for (int i = 50; i >= 30; --i) {
    now.T_odom_base = {0.01 * i, 0.0, 0.0};
    back_up.record(now.T_odom_base, -0.15);
  }
  const auto motion = back_up.step(now, brake);
  ASSERT_TRUE(motion);
  EXPECT_LT(motion->forward_mps, -0.05);
  EXPECT_EQ(motion->yaw_rate_rad_s, 0.0);
}

}  // namespace back_up_test
}  // namespace nodmap::navigator
