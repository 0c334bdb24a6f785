// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/crowd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace crowd_test {

// A robot far from everything.
const geometry::SE2 kAway{100.0, 100.0, 0.0};

Actor walker(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double speed_mps) {
  Actor actor;
  actor.path = {{0.0, from}, {(to - from).norm() / speed_mps, to}};
  actor.reacts = true;
  return actor;
}

// Advances the crowd in steps of a millisecond, as the robot model does.
void advance(Crowd& crowd, double from_s, double to_s, const geometry::SE2& robot = kAway) {
  for (int i = 1; i <= std::lround(1e3 * (to_s - from_s)); ++i) {
    crowd.advance(from_s + 1e-3 * i, robot);
  }
}

TEST(Crowd, AnActorThatDoesNotReactFollowsItsPath) {
  World world;
  world.actors.push_back(walker({0.0, 0.0}, {8.0, 0.0}, 1.0));
  world.actors[0].reacts = false;
  Crowd crowd(world, {});
  advance(crowd, 0.0, 3.0, {3.0, 0.0, 0.0});  // the stationary robot is in the way
  EXPECT_EQ(crowd.state(0).position, world.actors[0].position(3.0));
}

TEST(Crowd, LegsWalkAlong) {
  for (const bool reacts : {false, true}) {
    World world;
    world.actors.push_back(walker({0.0, 0.0}, {8.0, 0.0}, 1.0));
    world.actors[0].reacts = reacts;
    Crowd crowd(world, {});
    EXPECT_FALSE(crowd.state(0).legs);
    world.actors[0].has_legs = true;
    crowd = Crowd(world, {});
    advance(crowd, 0.0, 3.0);
    const ActorState state = crowd.state(0);
    ASSERT_TRUE(state.legs);
    EXPECT_NEAR((0.5 * (state.legs->left + state.legs->right) - state.position).norm(), 0.0, 1e-12);
    EXPECT_NEAR(state.legs->left.y(), 0.1, 1e-9);
  }
}

// v = v0 (1 - exp(-t / tau)) with tau = 0.5 s: at 1 m/s he has walked 3.5 m after 4 s.
TEST(Crowd, AnUndisturbedWalkerReachesItsDesiredSpeedAndStopsAtTheEnd) {
  World world;
  world.actors.push_back(walker({0.0, 0.0}, {8.0, 0.0}, 1.0));
  Crowd crowd(world, {});
  advance(crowd, 0.0, 4.0);
  EXPECT_NEAR(crowd.state(0).position.x(), 3.5, 0.02);  // steps of 20 ms
  EXPECT_EQ(crowd.state(0).position.y(), 0.0);
  advance(crowd, 4.0, 15.0);
  EXPECT_NEAR(crowd.state(0).position.x(), 8.0, 0.35);  // he arrives within 0.3 m, and a step
}

TEST(Crowd, WalkersMakeWayForTheStationaryRobot) {
  World world;
  world.actors.push_back(walker({0.0, 0.05}, {8.0, 0.0}, 1.3));
  const BodyParams body;
  Crowd crowd(world, body);
  double nearest_m = 10.0;
  const Eigen::Vector2d robot(4.0, 0.0);
  for (int i = 1; i <= 12'000; ++i) {
    crowd.advance(1e-3 * i, {robot.x(), robot.y(), 0.0});
    nearest_m = std::min(nearest_m, (crowd.state(0).position - robot).norm());
  }
  EXPECT_GT(nearest_m, 0.5 * std::hypot(body.length_m, body.width_m) + 0.25);
  EXPECT_GT(crowd.state(0).position.x(), 7.5);
}

TEST(Crowd, TwoWalkersWhoMeetPassEachOther) {
  World world;
  world.actors.push_back(walker({0.0, 0.0}, {8.0, 0.0}, 1.0));
  world.actors.push_back(walker({8.0, 0.1}, {0.0, 0.1}, 1.0));
  Crowd crowd(world, {});
  double nearest_m = 10.0;
  for (int i = 1; i <= 12'000; ++i) {
    crowd.advance(1e-3 * i, kAway);
    nearest_m = std::min(nearest_m, (crowd.state(0).position - crowd.state(1).position).norm());
  }
  EXPECT_GT(nearest_m, 0.5);  // twice the radius
  EXPECT_GT(crowd.state(0).position.x(), 7.5);
  EXPECT_LT(crowd.state(1).position.x(), 0.5);
}

TEST(Crowd, AWalkerDoesNotWalkIntoAWall) {
  World world;
  world.objects.push_back({Box{{4.0, 0.0, 1.0}, {0.2, 4.0, 2.0}, 0.3}});
  world.actors.push_back(walker({0.0, 0.0}, {8.0, 0.0}, 1.5));
  Crowd crowd(world, {});
  advance(crowd, 0.0, 5.0);
  const geometry::SE2 T_world_box{4.0, 0.0, 0.3};
  const Eigen::Vector2d local = T_world_box.inverse() * crowd.state(0).position;
  EXPECT_LT(local.x(), -0.1 - world.actors[0].radius_m);
}

TEST(Crowd, AWalkerOnALoopBeginsItAgain) {
  World world;
  Actor actor = walker({0.0, 0.0}, {2.0, 0.0}, 1.0);
  actor.path.push_back({4.0, {0.0, 0.0}});
  actor.loop = true;
  world.actors.push_back(actor);
  Crowd crowd(world, {});
  double least = 10.0;
  double most = -10.0;
  for (int i = 1; i <= 20'000; ++i) {
    crowd.advance(1e-3 * i, kAway);
    const double x = crowd.state(0).position.x();
    least = i > 10'000 ? std::min(least, x) : least;
    most = i > 10'000 ? std::max(most, x) : most;
  }
  // He arrives within 0.3 m, and a step.
  EXPECT_LT(least, 0.35);
  EXPECT_GT(most, 1.65);
}

}  // namespace crowd_test
}  // namespace nodmap::sim
