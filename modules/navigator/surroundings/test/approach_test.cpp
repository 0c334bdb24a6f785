// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/approach.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/test/point_world.hpp"

namespace nodmap::navigator {
namespace approach_test {

using geometry::deg_to_rad;

// All directions up to 70 degrees from ahead are seen.
SeenDirections seen_ahead() {
  SeenDirections view(SteerParams{});
  view.update(0.0, 0);
  view.update(0.0, 2);
  return view;
}

// A robot at this place, which has seen these directions.
Situation at(time::Timestamp stamp, const SeenDirections& seen,
             const geometry::SE2& T_odom_base = {}) {
  Situation now;
  now.stamp = stamp;
  now.seen = &seen;
  now.T_odom_base = T_odom_base;
  return now;
}

TEST(Approach, APointIsDetectedWhileItComesNearerAndNotAfterItHasStopped) {
  Approach approach;
  const SeenDirections view = seen_ahead();
  time::Timestamp stamp{};
  for (double x_m = 2.0; x_m > 0.3; x_m -= 0.01, stamp += 10ms) {  // 1 m/s
    approach.update(at(stamp, view), 0.9, {{x_m, 0.1}, {0.0, 0.4}});
    // It is detected once it has come 6 cm nearer, so up to 6 cm inside the reach of 0.9 m.
    if (x_m > 0.91) {
      EXPECT_FALSE(approach.is_detected(stamp)) << x_m;
    } else if (x_m < 0.83) {
      EXPECT_TRUE(approach.is_detected(stamp)) << x_m;
    }
  }
  for (int i = 0; i < 101; ++i, stamp += 10ms) {
    approach.update(at(stamp, view), 0.9, {{0.3, 0.1}, {0.0, 0.4}});
  }
  EXPECT_FALSE(approach.is_detected(stamp));  // it has stopped for a second
}

TEST(Approach, ARotationOfTheRobotIsNotAnApproach) {
  // A wall and a pole at half a metre, seen from headings a degree apart, with 2 cm of noise.
  Approach approach;
  SeenDirections view(SteerParams{});
  for (int i = 0; i < 400; ++i) {
    const double heading_rad = deg_to_rad(i);
    view.update(geometry::normalize_angle(heading_rad), i / 20);
    Points points_base;
    const double noise_m = 0.02 * ((i * 7) % 5 - 2) / 2.0;
    for (double y = -2.0; y < 2.0; y += 0.02) {
      points_base.emplace_back(0.5 + noise_m, y);
    }
    points_base.emplace_back(-0.5 + noise_m, 0.0);
    for (Eigen::Vector2d& p : points_base) {
      p = geometry::SE2{0.0, 0.0, -heading_rad}.rotation() * p;
    }
    approach.update(at(time::Timestamp(i * 10ms), view, {0.0, 0.0, heading_rad}), 0.9, points_base);
    EXPECT_FALSE(approach.is_detected(time::Timestamp(i * 10ms))) << i;
  }
}

TEST(Approach, APointThatComesIntoViewIsNotAnApproach) {
  Approach approach;
  const SeenDirections view = seen_ahead();
  approach.update(at(time::Timestamp(0s), view), 0.9, {});
  // Beside it, where the laser had not looked.
  approach.update(at(time::Timestamp(10ms), view), 0.9, {{-0.1, 0.5}});
  EXPECT_FALSE(approach.is_detected(time::Timestamp(10ms)));
  // Ahead, where it had.
  approach.update(at(time::Timestamp(20ms), view), 0.9, {{-0.1, 0.5}, {0.5, 0.0}});
  EXPECT_TRUE(approach.is_detected(time::Timestamp(20ms)));
}

// The robot drives at 1 m/s past a wall, a pole and a doorway, behind which there is another wall;
// the noise is 1 cm.
TEST(Approach, DrivingPastAWallIsNotAnApproach) {
  Approach approach;
  const SeenDirections view = seen_ahead();
  test::World world;
  world.add_wall({-1, 0.6}, {2.0, 0.6});
  world.add_wall({2.9, 0.6}, {6.0, 0.6});
  world.add_wall({2.0, 2.0}, {2.9, 2.0});
  world.add_pillar({2.5, -0.5}, 0.02);
  for (int i = 0; i < 300; ++i) {
    const geometry::SE2 T_odom_base{0.01 * i, 0.0, 0.0};
    Points points_base = test::ideal_map(world, T_odom_base);
    for (Eigen::Vector2d& p : points_base) {
      p *= 1.0 + 0.01 * ((i * 7) % 5 - 2) / 2.0 / p.norm();
    }
    approach.update(at(time::Timestamp(i * 10ms), view, T_odom_base), 1.5, points_base);
    EXPECT_FALSE(approach.is_detected(time::Timestamp(i * 10ms))) << i;
  }
}

// A pole comes into view beyond the reach, and then into the reach, first because the robot drives
// on by less than the reference point's 0.3 m, then because the reach grows with its speed.
TEST(Approach, AStationaryPoleThatComesIntoReachIsNotAnApproach) {
  const SeenDirections view = seen_ahead();
  const Eigen::Vector2d pole_odom(1.3, 0.0);
  Approach driving;
  Approach speeding_up;
  const Points wall{{3.0, 0.0}};  // behind the pole
  driving.update(at(time::Timestamp(0s), view), 1.1, wall);
  speeding_up.update(at(time::Timestamp(0s), view), 1.1, wall);
  for (int i = 1; i < 28; ++i) {
    const time::Timestamp stamp(i * 10ms);
    const geometry::SE2 T_odom_base{0.01 * i, 0.0, 0.0};
    driving.update(at(stamp, view, T_odom_base), 1.1, {T_odom_base.inverse() * pole_odom});
    EXPECT_FALSE(driving.is_detected(stamp)) << i;
    speeding_up.update(at(stamp, view), 1.1 + 0.01 * i, {pole_odom});
    EXPECT_FALSE(speeding_up.is_detected(stamp)) << i;
  }
}

// Noise moves the pole to and fro over the border of two sectors, 10 degrees to the left.
TEST(Approach, AStationaryPoleOnTheBorderOfTwoSectorsIsNotAnApproach) {
  Approach approach;
  const SeenDirections view = seen_ahead();
  for (int i = 0; i < 20; ++i) {
    const double pole_rad = deg_to_rad(i % 4 < 2 ? 9.9 : 10.1);
    const Points points_base{{std::cos(pole_rad), std::sin(pole_rad)}, {2.5, 0.3}, {2.5, 0.6}};
    approach.update(at(time::Timestamp(i * 10ms), view), 1.5, points_base);
    EXPECT_FALSE(approach.is_detected(time::Timestamp(i * 10ms))) << i;
  }
}

TEST(Approach, APersonWhoCrossesThePathIsDetected) {
  Approach approach;
  const SeenDirections view = seen_ahead();
  for (int i = 0; i < 100; ++i) {
    const double time_s = 0.01 * i;
    const geometry::SE2 T_odom_base{0.5 * time_s, 0.0, 0.0};
    const Eigen::Vector2d walker_odom(1.5, 1.5 - 1.0 * time_s);  // crosses its path
    const Points points_base{T_odom_base.inverse() * walker_odom};
    approach.update(at(time::Timestamp(i * 10ms), view, T_odom_base), 1.5, points_base);
  }
  EXPECT_TRUE(approach.is_detected(time::Timestamp(990ms)));
  EXPECT_FALSE(approach.is_detected(time::Timestamp(990ms) - 2s)) << "a clock that was set back";
}

// Whether something at (1.0, 0) counts as an approach: the laser first sees free floor there, then
// `after`.
bool is_approach(const test::Ground& after) {
  LocalMap map({}, {});
  const auto look = [&](const test::Ground& ground) {
    for (double deg = -30.0; deg <= 2.0; deg += 1.0) {
      map.add_scan(test::scan_of(ground, {}, deg_to_rad(deg)), {});
    }
  };
  look({});
  Approach approach;
  const SeenDirections view = seen_ahead();
  Situation now = at(time::Timestamp(0s), view);
  now.local_map = &map;
  approach.update(now, 1.5, {});
  look(after);
  now.stamp = time::Timestamp(10ms);
  approach.update(now, 1.5, {{1.0, 0.0}});
  return approach.is_detected(time::Timestamp(10ms));
}

// Two legs side by side have come. A plank of 6 cm may have been there before, between two scan
// lines.
TEST(Approach, ALegIsAnApproachALowPlankIsNot) {
  EXPECT_TRUE(is_approach({{{{0.98, -0.1}, {1.15, 0.1}, 1.7}}}));
  EXPECT_FALSE(is_approach({{{{0.98, -0.1}, {1.15, 0.1}, 0.06}}}));
}

// A mixed pixel, alone or at the edge of a pillar: the obstacle map has it, the local map has not.
TEST(Approach, APointThatTheLocalMapDoesNotShowIsNotAnApproach) {
  EXPECT_FALSE(is_approach({}));
  EXPECT_FALSE(is_approach({{{{0.935, 0.03}, {0.945, 0.3}, 1.7}}}));
}

}  // namespace approach_test
}  // namespace nodmap::navigator
