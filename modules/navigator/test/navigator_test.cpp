// SPDX-License-Identifier: BSD-3-Clause
// What the navigator decides on open floor that the laser has seen all around.
#include "modules/navigator/navigator.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace navigator_test {

constexpr double kStepS = 0.01332;

struct NavigatorTest : testing::Test {
  NavigatorTest() {
    now.max_forward_mps = 1.0;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const geometry::SE2 T_odom_base{0.0, 0.0, 0.5 * geometry::kPi * quarter};
      for (double deg = -60.0; deg <= 2.0; deg += 3.0) {
        navigator.add_scan(test::scan_of({}, T_odom_base, geometry::deg_to_rad(deg)), T_odom_base);
      }
    }
  }

  /// One decision, a scan later. In the meantime the laser has seen what is ahead.
  Decision decide(const Eigen::Vector2d& goal_odom) {
    now.stamp += time::from_seconds(kStepS);
    now.sweep_count += 2;
    now.goal = goal_in_base(now.T_odom_base.inverse() * goal_odom, 0.1);
    return navigator.decide(now);
  }

  Navigator navigator{NavigatorParams{}};
  Situation now;
};

// The goal is behind the robot, so it would rotate.
TEST_F(NavigatorTest, WithoutASpeedFromThePitchControllerItDoesNotMoveToAGoal) {
  now.max_forward_mps = 0.0;
  for (int i = 0; i < 60; ++i) {  // 0.8 s, more than planning takes
    const Decision decision = decide({-2.0, 0.0});
    EXPECT_EQ(decision.forward_mps, 0.0);
    EXPECT_EQ(decision.yaw_rate_rad_s, 0.0);
    EXPECT_EQ(decision.reason, Reason(Why::kNoSpeed));
  }
  now.max_forward_mps = 1.0;
  Decision decision;
  for (int i = 0; i < 60; ++i) {
    decision = decide({-2.0, 0.0});
  }
  EXPECT_GT(std::abs(decision.yaw_rate_rad_s), 0.1);
}

}  // namespace navigator_test
}  // namespace nodmap::navigator
