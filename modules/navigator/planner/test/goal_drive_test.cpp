// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/goal_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kStepS = 0.01332;

/// A map of a fence of 2.2 m around the robot, as seen from where it is.
LocalMap fenced() {
  const test::Ground fence{{{{1.0, -1.1}, {1.1, 1.1}, 0.5},
                            {{-1.1, -1.1}, {-1.0, 1.1}, 0.5},
                            {{-1.1, 1.0}, {1.1, 1.1}, 0.5},
                            {{-1.1, -1.1}, {1.1, -1.0}, 0.5}}};
  LocalMap map({}, {});
  for (int quarter = 0; quarter < 4; ++quarter) {
    const geometry::SE2 T_odom_turned{0.0, 0.0, 0.5 * geometry::kPi * quarter};
    for (double deg = -60.0; deg <= 2.0; deg += 3.0) {
      map.add_scan(test::scan_of(fence, T_odom_turned, geometry::deg_to_rad(deg)), T_odom_turned);
    }
  }
  return map;
}

TEST(GoalDrive, WithoutAPathItLooksAroundOnceAndThenSaysSoAndStays) {
  const LocalMap map = fenced();
  GoalDrive drive({});
  SeenDirections seen(geometry::deg_to_rad(70.0));
  Situation now;
  now.local_map = &map;
  now.max_forward_mps = 1.0;
  double rotated_rad = 0.0;
  Decision decision;
  for (int i = 0; i < 1500; ++i) {  // 20 s
    now.utime_us = std::llround(1e6 * kStepS * i);
    now.goal = goal_in_base(now.T_odom_base.inverse() * Eigen::Vector2d(4.0, 0.0), 0.3);
    now.points_base = map.points_base(now.T_odom_base, 2.5);
    decision = drive.decide(now, seen, map);
    EXPECT_EQ(decision.forward_mps, 0.0);
    now.yaw_rate_rad_s = decision.yaw_rate_rad_s;
    now.T_odom_base.yaw += kStepS * decision.yaw_rate_rad_s;
    rotated_rad += kStepS * std::abs(decision.yaw_rate_rad_s);
  }
  EXPECT_EQ(decision.reason, "There is no path to the goal.");
  EXPECT_EQ(decision.yaw_rate_rad_s, 0.0);
  // Once around; it begins after one step more or less, of 0.7 degrees each.
  EXPECT_NEAR(rotated_rad, 2.0 * geometry::kPi, 0.05);
}

}  // namespace
}  // namespace nodmap::navigator
