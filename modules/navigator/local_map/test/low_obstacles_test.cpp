// SPDX-License-Identifier: BSD-3-Clause
// What is hardly higher than the floor's tolerance: sills, bricks, and single beams.
#include <gtest/gtest.h>

#include <cmath>

#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace low_obstacles_test {

using geometry::deg_to_rad;
using test::Ground;

// A low sill is hit by one line of each sweep; other lines hit the floor in the cells of its face.
// It outweighs three of those; but when many lines hit the floor, the floor wins.
TEST(LowObstacles, ALowSillThatWasHitTwiceOutweighsThreeLinesOnTheFloor) {
  LocalMap map({}, {});
  const Ground sill{{{{0.9, -0.6}, {1.0, 0.6}, 0.05}}};
  for (const double deg : {-24.0, -24.5}) {
    map.add_scan(test::scan_of(sill, {}, deg_to_rad(deg)), {});
  }
  const auto points = [&] { return map.points_base({}, 2.0).size(); };
  const auto before = points();
  ASSERT_GT(before, 20U);
  for (int i = 0; i < 3; ++i) {
    map.add_scan(test::scan_of({}, {}, deg_to_rad(-26.5)), {});
  }
  EXPECT_EQ(points(), before);
  for (int i = 0; i < 12; ++i) {
    map.add_scan(test::scan_of({}, {}, deg_to_rad(-26.5)), {});
  }
  EXPECT_LT(points(), before);
}

// At 1.3 m/s the lines of one sweep are farther apart than the cells, so that each cell of the sill
// is hit at most once. Even so, most of its width is known.
TEST(LowObstacles, ALowSillIsKnownFromOneSweepOfAFastRobot) {
  LocalMap map({}, {});
  const Ground sill{{{{1.5, -0.6}, {1.6, 0.6}, 0.037}}};
  double x_m = 0.0;
  for (double deg = -22.0; deg < -12.0; deg += 1.3) {
    const geometry::SE2 T_odom_base{x_m, 0.0, 0.0};
    map.add_scan(test::scan_of(sill, T_odom_base, deg_to_rad(deg)), T_odom_base);
    x_m += 0.0173;
  }
  // In strips of 5 cm: beams are 2.5 cm apart in the middle of the sill, and more at its ends.
  int known = 0;
  for (double y = -0.5; y < 0.44; y += 0.05) {
    bool is_blocked = false;
    for (double x = 1.49; x <= 1.61; x += 0.0125) {
      for (const double aside_m : {0.005, 0.025, 0.045}) {
        is_blocked = is_blocked || test::is_blocked_at(map, Eigen::Vector2d(x, y + aside_m));
      }
    }
    known += is_blocked ? 1 : 0;
  }
  EXPECT_GE(known, 12);  // measured: 14 of 19
}

// A single beam that ends a little above the floor counts as noise until the next scan confirms it:
// at this steep pitch five standard deviations of its range are that much height.
TEST(LowObstacles, ASingleBeamALittleAboveTheFloorIsNotAnObstacle) {
  LocalMap map({}, {});
  scan::Scan scan = test::scan_of({}, {}, deg_to_rad(-50.0));
  scan.ranges_m[90] -= 0.05F;  // 3.8 cm above the floor
  map.add_scan(scan, {});
  EXPECT_TRUE(map.points_base({}, 2.0).empty());
  scan.ranges_m[91] -= 0.05F;
  map.add_scan(scan, {});
  EXPECT_FALSE(map.points_base({}, 2.0).empty());
}

// A brick of 3 cm is hit by one beam, whose range is ten standard deviations too short: that is not
// noise.
TEST(LowObstacles, ASingleBeamFarOffTheLineOnTheFloorIsAnObstacle) {
  LocalMap map({}, {});
  scan::Scan scan = test::scan_of({}, {}, deg_to_rad(-15.0));
  scan.ranges_m[90] -= 0.1F;  // 2.6 cm above the floor
  map.add_scan(scan, {});
  EXPECT_FALSE(map.points_base({}, 2.0).empty());
}

// A brick at 1.8 m, 2.8 cm high and 8 cm wide; the tolerance there is 3.3 cm. It is found by the
// floor beside it, even where the whole line is measured 1 cm too high or too low.
TEST(LowObstacles, ABrickIsFoundByTheFloorOnTheSameLine) {
  const Ground ground{{{{1.8, -0.04}, {1.9, 0.04}, 0.028}}};
  // The line crosses the brick's top.
  const double pitch_rad = -std::atan2(0.38 - 0.028, 1.82 - 0.15);
  for (const double error_deg : {0.0, 0.3, -0.3}) {
    scan::Scan scan = test::scan_of(ground, {}, pitch_rad);
    scan.pitch_first_rad = scan.pitch_last_rad = pitch_rad + deg_to_rad(error_deg);
    LocalMap map({}, {});
    map.add_scan(scan, {});
    const Points points = map.points_base({}, 2.5);
    ASSERT_FALSE(points.empty()) << error_deg;
    for (const Eigen::Vector2d& p : points) {
      EXPECT_NEAR(p.x(), 1.82, 0.05) << error_deg;  // a cell, and the error of 1 cm in height
      EXPECT_NEAR(p.y(), 0.0, 0.06) << error_deg;
    }
  }
}

}  // namespace low_obstacles_test
}  // namespace nodmap::navigator
