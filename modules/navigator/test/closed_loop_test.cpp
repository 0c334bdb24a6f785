// SPDX-License-Identifier: BSD-3-Clause
// Steer, Brake and Turn together, driving a simple robot through a world of points.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "modules/navigator/test/point_world.hpp"

namespace nodmap::navigator {
namespace closed_loop_test {

using geometry::rad_to_deg;
using test::ClosedLoop;
using test::World;

// How often the rotation on the spot changes its direction.
struct RotationMonitor {
  void watch(const ClosedLoop& loop) {
    const double rate = loop.decision.yaw_rate_rad_s;
    if (loop.decision.behaviour != Behaviour::kTurn || rate == 0.0) {
      return;
    }
    reversals += side * rate < 0.0 ? 1 : 0;
    side = std::copysign(1.0, rate);
  }
  double side = 0.0;
  int reversals = 0;
};

TEST(ClosedLoop, DoesNotDriveInADirectionBeforeTheLaserHasSeenIt) {
  ClosedLoop loop({}, {});
  loop.run(0.6);  // the head has reversed once, at 0.35 s
  EXPECT_EQ(loop.driven_m, 0.0);
  loop.run(1.0);
  EXPECT_GT(loop.driven_m, 0.3);
}

TEST(ClosedLoop, StopsBeforeAWallAtTheStopMargin) {
  World world;
  world.add_wall({2, -3}, {2, 3});
  NavigatorParams params;
  params.steer.view_half_rad = geometry::deg_to_rad(10.0);  // too narrow to steer past the wall
  ClosedLoop loop(world, {}, params);
  while (loop.decision.behaviour != Behaviour::kTurn || loop.driven_m == 0.0) {
    loop.cycle();
    ASSERT_LT(loop.time_s, 20.0);
  }
  // It does not drive slower than 6 cm/s, so it may stop 1.5 cm off.
  EXPECT_NEAR(loop.min_clearance_m, 0.15, 0.015);
}

// An obstacle that appears beyond v^2 / 2a + v T is never hit, whatever the robot is doing.
TEST(ClosedLoop, AnObstacleThatAppearsBeyondTheStoppingDistanceIsNotHit) {
  std::mt19937 random(29);
  std::uniform_real_distribution<double> aside(-0.25, 0.25);
  std::uniform_real_distribution<double> when(1.5, 4.0);
  const NavigatorParams params;
  double least_m = 1.0;
  for (int run = 0; run < 150; ++run) {
    World world;
    world.add_wall({-2, 1.5}, {9, 1.5});
    world.add_wall({-2, -1.5}, {9, -1.5});
    ClosedLoop loop(world, {});
    loop.max_forward_mps = 1.5;
    loop.run(when(random));
    const double v = loop.robot.forward_mps;
    const double braking_m =
        v * v / (2.0 * params.robot.braking.deceleration_mps2) + v * params.drive.reaction_s;
    const Eigen::Vector2d ahead(0.5 * params.robot.body.length_m + braking_m + 0.03, aside(random));
    loop.world.points_odom.emplace_back(loop.robot.T_odom_base * ahead);
    loop.run(3.0);
    EXPECT_FALSE(loop.collided) << "run " << run << " at " << v << " m/s";
    least_m = std::min(least_m, loop.min_clearance_m);
  }
  EXPECT_GT(least_m, 0.0);
}

// The first decision after the map that shows it is to brake.
TEST(ClosedLoop, BrakesForAnObstacleInTheFirstDecisionAfterItsMap) {
  ClosedLoop loop({}, {});
  loop.run(3.0);
  ASSERT_EQ(loop.decision.behaviour, Behaviour::kSteer);
  ASSERT_GT(loop.decision.forward_mps, 1.0);
  loop.world.points_odom.emplace_back(loop.robot.T_odom_base * Eigen::Vector2d(0.6, 0.0));
  loop.cycle();
  EXPECT_EQ(loop.decision.behaviour, Behaviour::kBrake);
  EXPECT_EQ(loop.decision.forward_mps, 0.0);
}

TEST(ClosedLoop, LeavesADeadEndWithinOneRotationAndAtMostTwoReversals) {
  for (const double half_width_m : {0.36, 0.4, 0.6, 1.0}) {
    World world;
    world.add_wall({-1, half_width_m}, {2, half_width_m});
    world.add_wall({-1, -half_width_m}, {2, -half_width_m});
    world.add_wall({2, -half_width_m}, {2, half_width_m});
    ClosedLoop loop(world, {});
    RotationMonitor monitor;
    double rotated_rad = 0.0;
    loop.on_decision = [&] {
      monitor.watch(loop);
      rotated_rad += loop.decision.behaviour == Behaviour::kTurn
                         ? std::abs(loop.robot.yaw_rate_rad_s) * 0.015
                         : 0.0;
    };
    while (loop.robot.T_odom_base.x > -1.0) {
      loop.cycle();
      ASSERT_LT(loop.time_s, 30.0) << half_width_m;
    }
    EXPECT_FALSE(loop.collided);
    EXPECT_LE(rad_to_deg(rotated_rad), 360.0);
    EXPECT_LE(monitor.reversals, 2);
  }
}

TEST(ClosedLoop, BacksUpAlongItsTrailWhereItIsTooNarrowToTurn) {
  World world;
  for (const double side : {1.0, -1.0}) {
    world.add_wall({-1, side * 0.4}, {1, side * 0.4});
    world.add_wall({1, side * 0.4}, {1, side * 0.26});
    world.add_wall({1, side * 0.26}, {3, side * 0.26});  // narrower than the body's diagonal
  }
  world.add_wall({3, -0.26}, {3, 0.26});
  ClosedLoop loop(world, {});
  double farthest_m = 0.0;
  while (loop.robot.T_odom_base.x > -1.0) {
    loop.cycle();
    farthest_m = std::max(farthest_m, loop.robot.T_odom_base.x);
    ASSERT_LT(loop.time_s, 60.0);
  }
  EXPECT_GT(farthest_m, 2.0);
  EXPECT_FALSE(loop.collided);
}

TEST(ClosedLoop, StopsTurningWhileAPersonWalksUpToIt) {
  World world;
  world.add_wall({-2, 0.6}, {0.42, 0.6});
  world.add_wall({-2, -0.6}, {0.42, -0.6});
  world.add_wall({0.42, -0.6}, {0.42, 0.6});
  ClosedLoop loop(world, {});
  loop.run(1.0);
  while (loop.decision.behaviour != Behaviour::kTurn || loop.robot.yaw_rate_rad_s < 0.9) {
    loop.cycle();
    ASSERT_LT(loop.time_s, 5.0);
  }
  // The person comes from the left ahead at 1 m/s, up to the margin around the turning circle.
  const std::size_t walls = loop.world.points_odom.size();
  const Eigen::Vector2d start = loop.robot.T_odom_base * Eigen::Vector2d(0.45, 0.78);
  const Eigen::Vector2d path = loop.robot.T_odom_base.translation() - start;
  for (double gone_m = 0.0; gone_m < path.norm() - 0.34; gone_m += 1.0 * 0.015) {
    loop.world.points_odom.resize(walls);
    loop.world.points_odom.emplace_back(start + gone_m * path.normalized());
    loop.cycle();
  }
  // 5 cm/s at the corner counts as stationary.
  EXPECT_LT(std::abs(loop.robot.yaw_rate_rad_s), 0.05 / 0.28);
  EXPECT_FALSE(loop.collided);
}

TEST(ClosedLoop, StopsBackingUpWhileAPersonWalksUpToIt) {
  World world;
  world.add_wall({-1, 0.26}, {2, 0.26});  // narrower than the body's diagonal
  world.add_wall({-1, -0.26}, {2, -0.26});
  world.add_wall({2, -0.26}, {2, 0.26});
  ClosedLoop loop(world, {});
  // The robot has backed up so far that the view ahead is clear.
  while (loop.robot.forward_mps > -0.09 || loop.robot.T_odom_base.x > 1.0) {
    loop.cycle();
    ASSERT_LT(loop.time_s, 30.0);
  }
  const std::size_t walls = loop.world.points_odom.size();
  const geometry::SE2 T_odom_before = loop.robot.T_odom_base;
  for (double x_m = 0.9; x_m > 0.25; x_m -= 1.0 * 0.015) {  // from ahead, 1 m/s
    loop.world.points_odom.resize(walls);
    loop.world.points_odom.emplace_back(T_odom_before * Eigen::Vector2d(x_m, 0.0));
    loop.cycle();
  }
  EXPECT_LT(std::abs(loop.robot.forward_mps), 0.05);  // counts as stationary
  EXPECT_FALSE(loop.collided);
}

// A person touched the robot while it turned: some of the person's points remain at the body's
// border.
TEST(ClosedLoop, AfterATouchWhileTurningItBacksUpAndGoesOn) {
  World world;
  world.add_wall({-3, 1.0}, {1, 1.0});
  world.add_wall({-3, -1.0}, {1, -1.0});
  world.add_wall({1, -1.0}, {1, 1.0});
  ClosedLoop loop(world, {});
  while (loop.decision.behaviour != Behaviour::kTurn || loop.driven_m == 0.0 ||
         loop.robot.yaw_rate_rad_s < 0.9) {
    loop.cycle();
    ASSERT_LT(loop.time_s, 10.0);
  }
  loop.run(0.3);
  const geometry::SE2 T_odom_touched = loop.robot.T_odom_base;
  for (const double y_m : {-0.03, -0.01, 0.01, 0.03}) {
    loop.world.points_odom.emplace_back(T_odom_touched * Eigen::Vector2d(0.229, y_m));
  }
  while ((loop.robot.T_odom_base.translation() - T_odom_touched.translation()).norm() < 0.3) {
    loop.cycle();
    ASSERT_LT(loop.time_s, 30.0);
  }
}

TEST(ClosedLoop, EnclosedItWaitsWithAReasonAndGoesOnWhenThereIsRoom) {
  World world;
  world.add_room(-0.5, 0.5, -0.5, 0.5);
  ClosedLoop loop(world, {});
  loop.run(15.0);
  EXPECT_FALSE(loop.collided);
  EXPECT_EQ(loop.decision.behaviour, Behaviour::kTurn);
  EXPECT_NE(loop.decision.reason, Reason(Why::kNothingToAdd));
  loop.world.points_odom.clear();
  loop.run(8.0);
  EXPECT_GT(loop.driven_m, 1.0);
}

TEST(ClosedLoop, LeavesAPocketThatOpensAwayFromTheGoal) {
  World world;
  world.add_room(-3, 8, -4, 4);
  world.add_wall({3, -1.5}, {3, 1.5});
  world.add_wall({1.5, 1.5}, {3, 1.5});
  world.add_wall({1.5, -1.5}, {3, -1.5});
  ClosedLoop loop(world, {});
  loop.goal_odom = Eigen::Vector2d(6.0, 0.3);
  while (loop.decision.behaviour != Behaviour::kArrived) {
    loop.cycle();
    ASSERT_LT(loop.time_s, 60.0);
  }
  loop.run(1.0);
  EXPECT_LT((loop.robot.T_odom_base.translation() - *loop.goal_odom).norm(), 0.3);
  EXPECT_LT(std::abs(loop.robot.forward_mps), 0.01);
  EXPECT_FALSE(loop.collided);
}

TEST(ClosedLoop, RoamsThroughClutterWithoutACollision) {
  double driven_m = 0.0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> x(0.7, 8.5);
    std::uniform_real_distribution<double> y(-3.5, 3.5);
    std::uniform_real_distribution<double> radius(0.015, 0.3);
    World world;
    world.add_room(-1, 9, -4, 4);
    for (int i = 0; i < 25; ++i) {
      const Eigen::Vector2d center(x(random), y(random));
      world.add_pillar(center, radius(random));
    }
    ClosedLoop loop(world, {});
    loop.run(30.0);
    EXPECT_FALSE(loop.collided) << "seed " << seed;
    EXPECT_GT(loop.driven_m, 10.0) << "seed " << seed;
    driven_m += loop.driven_m;
  }
  EXPECT_GT(driven_m / (8 * 30.0), 0.5);  // m/s in the mean
}

TEST(ClosedLoop, ASpeedBoundOfZeroFromThePitchControllerStopsIt) {
  ClosedLoop loop({}, {});
  loop.run(2.0);
  loop.max_forward_mps = 0.0;
  loop.run(1.0);
  EXPECT_EQ(loop.robot.forward_mps, 0.0);
  EXPECT_EQ(loop.decision.behaviour, Behaviour::kBrake);
}

// The head may not be sweeping, and the laser would not see what the rotation brings ahead.
TEST(ClosedLoop, ASpeedBoundOfZeroFromThePitchControllerStopsARotation) {
  World world;
  world.add_wall({0.5, -3}, {0.5, 3});
  ClosedLoop loop(world, {});
  while (std::abs(loop.robot.yaw_rate_rad_s) < 0.5) {
    loop.cycle();
    ASSERT_LT(loop.time_s, 5.0);
  }
  loop.max_forward_mps = 0.0;
  loop.run(0.5);
  EXPECT_EQ(loop.robot.yaw_rate_rad_s, 0.0);
  EXPECT_EQ(loop.decision.reason, Reason(Why::kNoSpeed));
  loop.max_forward_mps = 1.2;
  loop.run(0.5);
  EXPECT_GT(std::abs(loop.robot.yaw_rate_rad_s), 0.5) << "it goes on";
}

}  // namespace closed_loop_test
}  // namespace nodmap::navigator
