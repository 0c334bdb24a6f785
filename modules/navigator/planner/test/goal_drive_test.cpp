// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/goal_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace goal_drive_test {

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
    now.stamp = time::Timestamp(time::from_seconds(kStepS * i));
    now.goal = goal_in_base(now.T_odom_base.inverse() * Eigen::Vector2d(4.0, 0.0), 0.3);
    now.points_base = map.points_base(now.T_odom_base, 2.5);
    decision = drive.decide(now, seen, map);
    EXPECT_EQ(decision.forward_mps, 0.0);
    now.yaw_rate_rad_s = decision.yaw_rate_rad_s;
    now.T_odom_base.yaw += kStepS * decision.yaw_rate_rad_s;
    rotated_rad += kStepS * std::abs(decision.yaw_rate_rad_s);
  }
  EXPECT_EQ(decision.reason, Reason(Why::kNoPath));
  EXPECT_EQ(decision.yaw_rate_rad_s, 0.0);
  // Once around; it begins after one step more or less, of 0.7 degrees each.
  EXPECT_NEAR(rotated_rad, 2.0 * geometry::kPi, 0.05);
}

/// Of a robot on floor that it has seen, 2 m before its goal, between two rows of points that are
/// `beside_m` beside its body and as long as that and half a metre more.
Decision between_rows(double beside_m) {
  LocalMap map({}, {});
  for (double deg = -60.0; deg <= 2.0; deg += 3.0) {
    map.add_scan(test::scan_of({}, {}, geometry::deg_to_rad(deg)), {});
  }
  const robot::Footprint body = NavigatorParams().robot.body.footprint();
  Situation now;
  now.local_map = &map;
  now.max_forward_mps = 1.0;
  now.goal = goal_in_base({2.0, 0.0}, 0.3);
  for (double x = -body.half_length_m; x < body.half_length_m + 0.5; x += 0.01) {
    for (const double side : {-1.0, 1.0}) {
      now.points_base.emplace_back(x, side * (body.half_width_m + beside_m));
    }
  }
  SeenDirections seen(geometry::deg_to_rad(70.0));
  seen.update(0.0, 0);
  seen.update(0.0, 2);
  GoalDrive drive({});
  Decision decision;
  for (int i = 0; i < 40; ++i) {  // until there is a plan
    now.stamp = time::Timestamp(time::from_seconds(kStepS * i));
    decision = drive.decide(now, seen, map);
  }
  return decision;
}

TEST(GoalDrive, ItDrivesTheMoreSlowlyTheNarrowerAPlaceIs) {
  const DriveParams params;
  const double creep_m = 0.5 * (params.side_margin_m + params.creep_margin_m);
  const double squeeze_m = 0.5 * (params.creep_margin_m + params.squeeze_margin_m);
  EXPECT_GT(between_rows(params.side_margin_m + 0.01).forward_mps, params.creep_mps);
  const double creeping_mps = between_rows(creep_m).forward_mps;
  EXPECT_GT(creeping_mps, params.squeeze_mps);
  EXPECT_LE(creeping_mps, params.creep_mps);
  const double squeezing_mps = between_rows(squeeze_m).forward_mps;
  EXPECT_GT(squeezing_mps, 0.5 * params.squeeze_mps);
  EXPECT_LE(squeezing_mps, params.squeeze_mps);
  EXPECT_EQ(between_rows(0.5 * params.squeeze_margin_m).forward_mps, 0.0);
}

}  // namespace goal_drive_test
}  // namespace nodmap::navigator
