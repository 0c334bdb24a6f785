// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/local_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/navigator/ground/test/profile.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace local_map_test {

using geometry::deg_to_rad;
using test::Block;
using test::Ground;

constexpr double kCellM = 0.025;

// Sweeps from 60 degrees down to level, then back up.
void sweep(LocalMap& map, const Ground& ground, const geometry::SE2& T_odom_base, int times = 2) {
  for (int i = 0; i < times; ++i) {
    for (double deg = -60.0; deg <= 5.0; deg += 1.5) {
      map.add_scan(test::scan_of(ground, T_odom_base, deg_to_rad(i % 2 == 0 ? deg : -55.0 - deg)),
                   T_odom_base);
    }
  }
}

double nearest_m(const Points& points) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : points) {
    nearest = std::min(nearest, p.norm());
  }
  return nearest;
}

// A scan without any measurement.
scan::Scan blind_scan() {
  scan::Scan scan = test::scan_of({}, {}, 0.0);
  std::ranges::fill(scan.ranges_m, std::numeric_limits<float>::quiet_NaN());
  return scan;
}

// The front of a box is 1.15 m from the laser, and beams 30 degrees down meet the floor after 0.76
// m. Those without an echo say something about either only if the laser measures that far.
TEST(LocalMap, ABeamWithoutAnEchoSaysNothingBeyondTheLongestRange) {
  const Ground ground{{{{1.3, -0.3}, {1.6, 0.3}, 0.3}}};
  for (const double range_max_m : {80.0, 0.6}) {
    LocalMap map({}, {});
    sweep(map, ground, {});
    const Eigen::Vector2d on_box(1.31, 0.0);
    ASSERT_TRUE(test::is_blocked_at(map, on_box));
    scan::Scan scan = test::scan_of({}, {}, 0.0);
    std::ranges::fill(scan.ranges_m, std::numeric_limits<float>::infinity());
    scan.range_max_m = range_max_m;
    for (const double deg : {-30.0, -10.0}) {
      scan.pitch_first_rad = scan.pitch_last_rad = deg_to_rad(deg);
      for (int i = 0; i < 20; ++i) {
        map.add_scan(scan, {});
      }
    }
    EXPECT_EQ(test::is_blocked_at(map, on_box), range_max_m < 1.0);
    const Eigen::Vector2d before_box(0.15 + 0.38 / std::tan(deg_to_rad(30.0)), 0.01);
    EXPECT_EQ(test::is_blocked_at(map, before_box), range_max_m > 1.0) << "a hole";
  }
}

// The robot has touched glass 15 cm before a ramp, which is then found.
TEST(LocalMap, AContactStaysWhenItsPlaceJoinsARamp) {
  const double rise_m = 2.0 * std::tan(deg_to_rad(12.0));
  test::NoddingRobot robot({{{-40.0, 0.0}, {1.4, 0.0}, {3.4, rise_m}, {40.0, rise_m}}}, 0.01);
  LocalMap map({}, {});
  const geometry::SE2 T_odom_touched{1.0, 0.0, 0.0};
  const Eigen::Vector2d glass(1.0 + robot::Body{}.footprint().half_length_m + kCellM, 0.0);
  map.add_scan(robot.step(0.0), robot.T_odom_base());
  map.add_contact(T_odom_touched, true);
  ASSERT_TRUE(test::is_blocked_at(map, glass));
  for (int i = 0; robot.x() < 0.5; ++i) {
    map.add_scan(robot.step(i < 146 ? 0.0 : 0.3), robot.T_odom_base());
  }
  ASSERT_GT(map.ground().num_facets(), 1U);
  EXPECT_TRUE(test::is_blocked_at(map, glass));
}

TEST(LocalMap, FlatFloorHasNoPointsAndIsSeen) {
  LocalMap map({}, {});
  sweep(map, {}, {});
  EXPECT_TRUE(map.points_base({}, 3.0).empty());
  // Lines 1.5 degrees apart are 15 cm apart at 1.5 m: the floor is seen without gaps up to there.
  EXPECT_GT(map.seen_floor().distance({}, 0.0, 1.0, 0.15), 0.7);
}

// Every obstacle cell is within half a cell's diagonal of a block that rises from the floor. Every
// hole is that close to a pit, or on the edge around it, two cells wide. The near edge of each is
// found.
TEST(LocalMap, FindsSillsBoxesAndPitsWhereTheyAre) {
  struct Case {
    Block block;
    double nearest_m;
  };
  for (const Case& c :
       {Case{{{0.8, -0.6}, {0.9, 0.6}, 0.04}, 0.8}, Case{{{1.0, -0.3}, {1.5, 0.3}, 0.3}, 1.0},
        Case{{{0.9, -1.0}, {2.0, 1.0}, -0.17}, 0.9}, Case{{{0.9, -1.0}, {2.0, 1.0}, -9.0}, 0.9}}) {
    LocalMap map({}, {});
    const Ground ground{{c.block}};
    sweep(map, ground, {});
    const Points points = map.points_base({}, 2.0);
    // Lines are 4 cm apart on the floor 1 m ahead, and the edge of a pit may be between two.
    EXPECT_NEAR(nearest_m(points), c.nearest_m, 0.05) << c.block.height_m;
    for (const Eigen::Vector2d& p : points) {
      const Eigen::Vector2d nearest = p.cwiseMax(c.block.min).cwiseMin(c.block.max);
      const double edge_m = c.block.height_m < 0.0 ? 2.0 * kCellM : 0.0;
      EXPECT_LE((p - nearest).norm(), 0.5 * std::sqrt(2.0) * kCellM + edge_m + 0.002)
          << p.transpose();
    }
  }
}

// Beams pass over the edge and hit the ground up to 4 cm beyond it, the distance between two lines.
// Blocked cells must begin before the edge: then a body that keeps its clearance from points also
// keeps it from the edge.
TEST(LocalMap, AHoleIsBlockedFromItsEdge) {
  for (const double edge_m : {0.900, 0.907, 0.914, 0.921}) {
    LocalMap map({}, {});
    sweep(map, {{{{edge_m, -1.0}, {2.0, 1.0}, -0.5}}}, {});
    EXPECT_LE(nearest_m(map.points_base({}, 2.0)), edge_m + 0.5 * kCellM);
    EXPECT_TRUE(test::is_blocked_at(map, Eigen::Vector2d(edge_m + 0.01, 0.0)));
    EXPECT_FALSE(test::is_blocked_at(map, Eigen::Vector2d(edge_m - 0.1, 0.0)));
  }
}

// Looking along the side of a flight of stairs, the laser sees the far wall of the first step just
// below its edge, no lower than a ramp could be. So the last 20 cm before the corner are no hole,
// but they may be a ramp, all but the 9 cm that look like floor within the tolerance.
TEST(LocalMap, TheFarCornerOfAHoleIsKnown) {
  LocalMap map({}, {});
  const Ground stairs{{{{5.0, 0.6}, {5.3, 2.4}, -0.17}, {{5.3, 0.6}, {5.6, 2.4}, -0.34}}};
  const geometry::SE2 T_odom_base{4.43, 1.35, 1.09};
  sweep(map, stairs, T_odom_base);
  Points known = map.points_base(T_odom_base, 2.0);
  const Points marks = map.possible_ramps_down_base(T_odom_base, 2.0);
  EXPECT_FALSE(marks.empty());
  for (const Eigen::Vector2d& p : marks) {
    EXPECT_LT(stairs.height_m(T_odom_base * p), 0.0) << p.transpose();
  }
  known.insert(known.end(), marks.begin(), marks.end());
  for (double y = 1.6; y < 2.4 - 0.09; y += 0.02) {
    const Eigen::Vector2d p_base = T_odom_base.inverse() * Eigen::Vector2d(5.05, y);
    double nearest_m = 1.0;
    for (const Eigen::Vector2d& p : known) {
      nearest_m = std::min(nearest_m, (p - p_base).norm());
    }
    EXPECT_LT(nearest_m, 2.0 * kCellM + 0.02) << y;
  }
}

// A kerb of 8 cm, 1.2 m away, could be a ramp. Beams cross the floor beyond the edge only.
TEST(LocalMap, AKerbFarAwayMayBeARampDownAndBeginsAtItsEdge) {
  LocalMap map({}, {});
  sweep(map, {{{{1.2, -1.0}, {3.0, 1.0}, -0.08}}}, {});
  const Points points = map.possible_ramps_down_base({}, 2.0);
  ASSERT_FALSE(points.empty());
  for (const Eigen::Vector2d& p : points) {
    EXPECT_GT(p.x(), 1.2 - 0.5 * kCellM) << p.transpose();
  }
  // Two lines are 6 cm apart there.
  EXPECT_LT(nearest_m(points), 1.2 + 0.06 + kCellM);
}

// Beams that end beyond the known part of a ramp pass over that part: they have not passed through
// it, although they have passed below the level of the floor before it.
TEST(LocalMap, AKnownRampDownIsNoPossibleRamp) {
  LocalMap map({}, {});
  Ground ground;
  ground.ramp_from_x_m = 0.9;
  ground.slope = -std::tan(geometry::deg_to_rad(10.0));
  sweep(map, ground, {});
  EXPECT_FALSE(map.possible_ramps_down_base({}, 1.6).empty()) << "before the ramp is known";
  for (int i = 0; i < 3; ++i) {
    sweep(map, ground, {});
  }
  ASSERT_FALSE(map.ground().is_level());
  for (const Eigen::Vector2d& p : map.possible_ramps_down_base({}, 1.6)) {
    EXPECT_FALSE(std::abs(p.y()) < 0.3 && map.ground().is_known(p)) << p.transpose();
  }
}

// 29 cm in floating point are 28.999 cm: the beams that pass must count as being at the same height
// as those that hit.
TEST(LocalMap, ALevelLaserClearsAnObstacleThatItSeesThrough) {
  LocalMap map({}, {});
  const auto look = [&](const Ground& ground, int times) {
    for (int i = 0; i < times; ++i) {
      scan::Scan scan = test::scan_of(ground, {}, 0.0);
      scan.T_base_mount.translation().z() = 0.29;
      map.add_scan(scan, {});
    }
  };
  look({{{{1.0, -0.2}, {1.2, 0.2}, 0.5}}}, 4);
  EXPECT_FALSE(map.points_base({}, 1.5).empty());
  // The evidence is at most 12, and each scan takes away one.
  look({{{{3.0, -3.0}, {3.2, 3.0}, 0.5}}}, 12);
  EXPECT_TRUE(map.points_base({}, 1.5).empty());
  EXPECT_TRUE(map.cell_at({1.01, 0.0})->is_cleared());
}

// Lines of sweeps up and down are at different pitches, in places half of 1.5 degrees apart: they
// are then 15 cm apart about 2 m ahead of the axis, and 30 cm apart at 2.9 m. Measured: floor up to
// 1.58 m and 2.25 m.
TEST(LocalMap, FloorIsSeenFartherWhereWiderGapsAreAllowed) {
  LocalMap map({}, {});
  sweep(map, {}, {});
  const double dense_m = map.seen_floor().distance({}, 0.0, 3.0, 0.15);
  const double wide_m = map.seen_floor().distance({}, 0.0, 3.0, 0.3);
  EXPECT_GT(dense_m, 1.58 / 1.25);
  EXPECT_LT(dense_m, 1.8);
  EXPECT_GT(wide_m, 2.25 / 1.25);
  EXPECT_LT(wide_m, 2.7);
}

TEST(LocalMap, GroundThatTheLaserDidNotSeeIsUnknown) {
  LocalMap map({}, {});
  const Ground ground{{{{1.0, -0.5}, {1.1, 0.5}, 0.3}}};
  sweep(map, ground, {});
  const LocalCell* behind = map.cell_at({1.5, 0.0});
  ASSERT_NE(behind, nullptr);
  EXPECT_FALSE(behind->is_floor);
  EXPECT_FALSE(behind->is_obstacle());
  EXPECT_LT(map.seen_floor().distance({}, 0.0, 2.0, 0.15), 1.0 - 0.225);
}

TEST(LocalMap, RemembersObstaclesBesideAndBehindTheRobot) {
  LocalMap map({}, {});
  const Ground ground{{{{0.8, 0.25}, {0.9, 0.35}, 0.08}}};
  sweep(map, ground, {});
  ASSERT_FALSE(map.points_base({}, 2.0).empty());
  for (double x = 0.0; x < 1.5; x += 0.05) {
    const geometry::SE2 T_odom_base{x, 0.0, 0.0};
    map.add_scan(test::scan_of(ground, T_odom_base, deg_to_rad(-10.0)), T_odom_base);
  }
  const Points points = map.points_base({1.5, 0.0, 0.0}, 2.0);
  ASSERT_FALSE(points.empty());
  // The block reaches 5 cm to each side of its middle, and its outermost cells reach 2 cm farther.
  for (const Eigen::Vector2d& p : points) {
    EXPECT_NEAR(p.x(), 0.85 - 1.5, 0.07);
    EXPECT_NEAR(p.y(), 0.3, 0.07);
  }
}

// The wall was seen on the way in; now it is behind and beside the robot. The robot rotates to and
// fro, 20 rad in all, without looking at the wall again: that counts as 80 m of driving.
TEST(LocalMap, AWallBesideARobotThatRotatesOnTheSpotIsRemembered) {
  LocalMap map({}, {});
  const Ground ground{{{{-0.5, -1.0}, {-0.4, 1.0}, 0.5}}};
  sweep(map, ground, {0.0, 0.0, geometry::kPi});
  const auto behind = [&] {
    const Points points = map.points_base({}, 1.0);
    return std::ranges::count_if(
        points, [](const Eigen::Vector2d& p) { return p.x() < -0.35 && p.norm() < 0.48; });
  };
  const auto before = behind();
  ASSERT_GT(before, 0);
  const scan::Scan none = blind_scan();
  for (int i = 0; i <= 160; ++i) {
    map.add_scan(none, {0.0, 0.0, 0.5 * std::sin(geometry::kPi * i / 8.0)});
  }
  EXPECT_EQ(behind(), before);
}

// The wall was last seen 40 m of driving ago, twice as far as obstacles are remembered. Odometry no
// longer tells where it is, even if the robot comes close to it.
TEST(LocalMap, AForgottenObstacleDoesNotComeBackNearTheRobot) {
  LocalMap map({}, {});
  sweep(map, {{{{1.5, -1.0}, {1.6, 1.0}, 0.5}}}, {});
  ASSERT_FALSE(map.points_base({}, 2.0).empty());
  for (int i = 0; i <= 100; ++i) {
    map.add_scan(blind_scan(), {-0.4 * (i % 2), 0.0, 0.0});
  }
  for (double x = 0.0; x < 1.2; x += 0.05) {
    const geometry::SE2 T_odom_base{x, 0.0, 0.0};
    map.add_scan(blind_scan(), T_odom_base);
    EXPECT_TRUE(map.points_base(T_odom_base, 2.0).empty()) << x;
  }
}

// By definition, doubtful ground is what is within 0.4 m of the robot, not under its body, and
// neither floor nor within two cells of floor.
TEST(LocalMap, GroundThatWasNotSeenIsDoubtful) {
  LocalMap map({}, {});
  sweep(map, {}, {});
  EXPECT_TRUE(map.doubtful_points_base({}, 0.4).empty());  // the robot was set down here
  // 2 m to the left of all the ground that was seen.
  const Points points = map.doubtful_points_base({-2.0, 2.0, 0.3}, 0.4);
  const robot::Footprint body = robot::Body{}.footprint();
  const double area_m2 = geometry::kPi * 0.16 - 4.0 * body.half_length_m * body.half_width_m;
  EXPECT_NEAR(static_cast<double>(points.size()) * kCellM * kCellM, area_m2, 0.05 * area_m2);
  for (const Eigen::Vector2d& p : points) {
    EXPECT_FALSE(body.contains(p));
    EXPECT_LT(p.norm(), 0.4 + kCellM);
  }
}

// The lowest beam meets the floor at 0.44 m. Beyond, whether the robot turns or not, floor must be
// seen.
TEST(LocalMap, FloorIsAssumedOnlyWhereTheLaserDoesNotSeeIt) {
  LocalMap map({}, {});
  map.add_scan(blind_scan(), {1.0, 2.0, 0.5});
  for (double angle_rad = 0.0; angle_rad < 2.0 * geometry::kPi; angle_rad += 0.1) {
    const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
    const auto is_floor = [&](double range_m) {
      return map.cell_at(Eigen::Vector2d(1.0, 2.0) + range_m * direction)->is_floor;
    };
    EXPECT_TRUE(is_floor(0.42)) << angle_rad;
    EXPECT_FALSE(is_floor(0.48)) << angle_rad;
  }
}

TEST(LocalMap, PointsOfAWalkerAreNotAddedToTheMap) {
  LocalMap map({}, {});
  const Ground ground{{{{0.9, -0.2}, {1.1, 0.2}, 0.45}}};
  for (double deg = -60.0; deg <= 5.0; deg += 1.5) {
    const scan::Scan scan = test::scan_of(ground, {}, deg_to_rad(deg));
    std::vector<bool> is_walker(scan.ranges_m.size());
    for (std::size_t i = 0; i < is_walker.size(); ++i) {
      const auto range_m = static_cast<double>(scan.ranges_m[i]);
      is_walker[i] = scan::point_in_base(scan, i, range_m).z() > 0.02;
    }
    map.add_scan(scan, {}, is_walker);
  }
  EXPECT_TRUE(map.points_base({}, 2.0).empty());
}

// A person has walked onto floor that was seen before; a box has always been there.
TEST(LocalMap, ForgetsAWalkerOnKnownFloorButNoBoxThatWasAlwaysThere) {
  const Ground ground{{{{0.9, -0.2}, {1.1, 0.2}, 0.45}}};
  LocalMap came({}, {});
  sweep(came, {}, {});
  sweep(came, ground, {});
  ASSERT_FALSE(came.points_base({}, 2.0).empty());
  came.forget_walker({1.0, 0.0}, 0.35);
  EXPECT_TRUE(came.points_base({}, 2.0).empty());
  LocalMap always_there({}, {});
  sweep(always_there, ground, {});
  const std::size_t num_points = always_there.points_base({}, 2.0).size();
  always_there.forget_walker({1.0, 0.0}, 0.35);
  EXPECT_EQ(always_there.points_base({}, 2.0).size(), num_points);
}

TEST(LocalMap, ForgetsAnObstacleThatBeamsPassThrough) {
  LocalMap map({}, {});
  sweep(map, {{{{0.9, -0.2}, {1.1, 0.2}, 0.4}}}, {});
  ASSERT_FALSE(map.points_base({}, 2.0).empty());
  sweep(map, {}, {}, 4);
  EXPECT_TRUE(map.points_base({}, 2.0).empty());
}

TEST(LocalMap, AHoleThatIsClosedBecomesFloor) {
  LocalMap map({}, {});
  sweep(map, {{{{0.8, -0.3}, {1.2, 0.3}, -0.2}}}, {});
  ASSERT_FALSE(map.points_base({}, 2.0).empty());
  sweep(map, {}, {}, 16);
  EXPECT_TRUE(map.points_base({}, 1.1).empty());
}

// Mounted 1 m high and never looking down by more than 10 degrees, the laser sees the floor 6.6 m
// ahead, beyond the corners of the grid.
TEST(LocalMap, ABlindAreaLargerThanTheGridIsNoError) {
  robot::RobotParams robot;
  robot.mount.z_m = 1.0;
  robot.head.pitch_min_rad = deg_to_rad(-10.0);
  LocalMap map(robot, {});
  const geometry::SE2 T_odom_base{0.0, 0.0, 0.25 * geometry::kPi};
  map.add_scan(test::scan_of({}, T_odom_base, 0.0), T_odom_base);
  EXPECT_TRUE(map.is_only_floor({5.0, 0.0}));
}

TEST(LocalMap, IgnoresInvalidReadingsAndPoses) {
  LocalMap map({}, {});
  scan::Scan scan = test::scan_of({}, {}, deg_to_rad(-30.0));
  std::ranges::fill(scan.ranges_m, std::numeric_limits<float>::quiet_NaN());
  map.add_scan(scan, {});
  scan.ranges_m.clear();
  map.add_scan(scan, {});
  map.add_scan(test::scan_of({}, {}, deg_to_rad(-30.0)), {1e12, -1e12, 1.0});
  EXPECT_TRUE(map.points_base({}, 2.0).empty());
}

}  // namespace local_map_test
}  // namespace nodmap::navigator
