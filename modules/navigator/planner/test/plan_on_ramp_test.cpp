// SPDX-License-Identifier: BSD-3-Clause
// How the global planner plans over what may be a ramp.
#include <gtest/gtest.h>

#include <cmath>

#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/planner/global_planner.hpp"

namespace nodmap::navigator {
namespace plan_on_ramp_test {

using test::Ground;

const Eigen::Vector2d kGoal(6.0, 0.0);

// A room, 3.5 m ahead of the robot, 2 m wide, with walls of 2 m and a way out at its far end.
Ground room() {
  return {.blocks = {{{-1.1, -1.1}, {-1.0, 1.1}, 2.0},
                     {{-1.1, 1.0}, {8.0, 1.1}, 2.0},
                     {{-1.1, -1.1}, {8.0, -1.0}, 2.0}}};
}

// The room, with a ramp of `slope_deg` to its far end.
Ground room_with_ramp(double slope_deg) {
  Ground ground = room();
  ground.ramp_from_x_m = 2.5;
  ground.slope = std::tan(geometry::deg_to_rad(slope_deg));
  return ground;
}

// The room, closed by something of this height.
Ground room_with_sill(double height_m) {
  Ground ground = room();
  ground.blocks.push_back({{2.5, -1.1}, {2.6, 1.1}, height_m});
  return ground;
}

// The cost of the way to the goal on this map, for a robot at `from_x_m`; infinity if there is
// none.
double cost_on(const LocalMap& map, double from_x_m, bool laser_is_held) {
  GlobalPlanner planner(robot::Body{}.footprint(), {});
  Situation now;
  now.T_odom_base = {from_x_m, 0.0, 0.0};
  now.local_map = &map;
  now.laser_is_held = laser_is_held;
  now.goal = GoalInBase{kGoal - Eigen::Vector2d(from_x_m, 0.0), 0.2};
  for (int i = 0; i < 400 && planner.cost_to_go() == nullptr; ++i) {
    now.stamp = time::Timestamp(13'320us * i);
    planner.step(now);
  }
  return planner.cost_to_go()->at({from_x_m, 0.0});
}

// The same after one look around from the start, and from `from_x_m`.
double cost_of(const Ground& ground, double from_x_m) {
  LocalMap map({}, {});
  test::look_around(map, ground);
  if (from_x_m != 0.0) {
    test::look_around(map, ground, {from_x_m, 0.0, 0.0});
  }
  return cost_on(map, from_x_m, false);
}

TEST(PlanOnRamp, FromAfarARampIsAWay) {
  for (const double slope_deg : {5.0, 8.0, 12.0}) {
    EXPECT_TRUE(std::isfinite(cost_of(room_with_ramp(slope_deg), 0.0))) << slope_deg;
  }
}

// Behind a sill nothing rises. Of one of 8 cm too little is seen from afar to close the room.
TEST(PlanOnRamp, ASillIsNone) {
  EXPECT_FALSE(std::isfinite(cost_of(room_with_sill(0.15), 0.0)));
  EXPECT_FALSE(std::isfinite(cost_of(room_with_sill(0.08), 1.5)));
}

TEST(PlanOnRamp, AWallIsNoneFromAnywhere) {
  EXPECT_FALSE(std::isfinite(cost_of(room_with_sill(0.5), 0.0)));
  EXPECT_FALSE(std::isfinite(cost_of(room_with_ramp(30.0), 0.0)));
}

// A level laser sees no floor before a wall, so that a ramp might lead up to what it sees.
TEST(PlanOnRamp, WhatAHeldLaserSeesIsNone) {
  LocalMap map({}, {});
  for (int i = 0; i < 80; ++i) {
    const geometry::SE2 T_odom_base{0.0, 0.0, geometry::deg_to_rad(90.0) * (i / 20)};
    map.add_scan(test::scan_of(room_with_sill(2.0), T_odom_base, 0.0), T_odom_base);
  }
  EXPECT_FALSE(std::isfinite(cost_on(map, 0.0, true)));
}

}  // namespace plan_on_ramp_test
}  // namespace nodmap::navigator
