// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/local_planner.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace local_planner_test {

// Somebody comes, ahead of the cheapest rollout. Brake would allow 0.28 m/s on it, and this loss of
// speed costs more than the rotation.
TEST(LocalPlanner, ARolloutThatMustGiveWayIsNotTheBest) {
  const NavigatorParams params;
  const LocalPlanner planner(params, false);
  SeenDirections seen(params.steer);
  seen.update(0.0, 0);
  const std::vector<Rollout> rollouts{{.forward_mps = 0.7, .cost_m = 1.0},
                                      {.yaw_rate_rad_s = 0.5, .cost_m = 1.1}};
  Situation now;
  now.seen = &seen;
  now.laser_is_held = true;  // nothing more will come into view
  now.max_forward_mps = 1.0;
  const auto alone = planner.drive_best_of(rollouts, now);
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->forward_mps, 0.7);
  now.people = {{{1.0, 0.0}, {-1.4, 0.0}, 0.25}};
  const auto with_somebody = planner.drive_best_of(rollouts, now);
  ASSERT_TRUE(with_somebody);
  EXPECT_EQ(with_somebody->forward_mps, 0.0);
  EXPECT_EQ(with_somebody->yaw_rate_rad_s, 0.5);
}

// It turns left at 1.2 m/s. A rotation to the right would lead it off its arc, which Brake has
// measured, and there is something ahead of it.
TEST(LocalPlanner, ARobotThatDrivesSlowsDownOnItsArcBeforeItRotates) {
  const NavigatorParams params;
  const LocalPlanner planner(params, false);
  Situation now;
  now.max_forward_mps = 1.5;
  now.yaw_rate_rad_s = 0.6;
  now.points_base = {{1.2, 0.0}};
  const auto rotate = [&](double forward_mps) {
    now.forward_mps = forward_mps;
    return planner.rotate(-1.0, now).value_or(Decision());
  };
  const Decision fast = rotate(1.2);
  EXPECT_EQ(fast.reason, Reason(Why::kTurnsToPath));
  EXPECT_GT(fast.forward_mps, 0.0);
  EXPECT_LT(fast.forward_mps, 1.2);
  EXPECT_NEAR(fast.yaw_rate_rad_s, 0.5 * fast.forward_mps, 1e-12);
  const Decision slow = rotate(0.05);
  EXPECT_EQ(slow.forward_mps, 0.0);
  EXPECT_EQ(slow.yaw_rate_rad_s, -1.0);
  // Too near for ordinary brakes: all of their force, and no rotation yet.
  now.points_base = {{0.5, 0.05}};
  EXPECT_EQ(rotate(1.2).forward_mps, 0.0);
  EXPECT_EQ(rotate(1.2).yaw_rate_rad_s, 0.0);
}

// Before it rotates it passes the speeds that ordinary brakes take at once: their command is to
// stop. If that did not count as a motion that can be driven, it would drive the arc, be faster,
// slow down again and so on, and drive in circles round a goal beside it.
TEST(LocalPlanner, ARobotThatIsToRotateDoesSoHoweverFastItDrives) {
  const NavigatorParams params;
  const LocalPlanner planner(params, false);
  SeenDirections seen(params.steer);
  seen.update(0.0, 0);
  const std::vector<Rollout> rollouts{{.yaw_rate_rad_s = 1.0, .cost_m = 1.0},
                                      {.forward_mps = 0.25, .yaw_rate_rad_s = -0.5, .cost_m = 1.1}};
  for (const double forward_mps : {0.05, 0.07, 0.1, 0.12, 0.3, 1.0}) {
    Situation now;
    now.seen = &seen;
    now.laser_is_held = true;
    now.max_forward_mps = 1.5;
    now.forward_mps = forward_mps;
    now.yaw_rate_rad_s = -2.0 * forward_mps;
    // At 75 decisions a second; 1 s is longer than an ordinary stop from 1 m/s takes.
    for (int i = 0; i < 75; ++i) {
      const auto decision = planner.drive_best_of(rollouts, now);
      ASSERT_TRUE(decision);
      EXPECT_EQ(decision->reason, Reason(Why::kTurnsToPath)) << now.forward_mps;
      const Twist next = after({now.forward_mps, now.yaw_rate_rad_s},
                               {decision->forward_mps, decision->yaw_rate_rad_s}, 1.0 / 75.0, {});
      EXPECT_LE(next.forward_mps, now.forward_mps);
      now.forward_mps = next.forward_mps;
      now.yaw_rate_rad_s = next.yaw_rate_rad_s;
    }
    EXPECT_EQ(now.forward_mps, 0.0);
    EXPECT_NEAR(now.yaw_rate_rad_s, 1.0, 1e-12);
  }
}

// The laser has looked 12 degrees to each side. An arc of curvature k leaves these directions where
// its chord does, at the length 2 * 12 degrees / k. The front is 0.225 m ahead, and up to 5 cm are
// lost to the step. So the robot is stationary before that place, however fast it may drive.
TEST(LocalPlanner, StopsBeforeWhereTheLaserHasNotLooked) {
  NavigatorParams params;
  params.steer.view_half_rad = geometry::deg_to_rad(12.0);
  const LocalPlanner planner(params, false);
  const Brake brake(params);
  SeenDirections seen(params.steer);
  seen.update(0.0, 0);
  seen.update(0.0, 2);
  Situation now;
  now.seen = &seen;
  now.max_forward_mps = 1.5;
  const auto forward_mps = [&](double curvature) {
    const double limit_mps = brake.speed_limit(curvature, 1.5);
    return planner.drive({limit_mps, limit_mps * curvature}, now).value_or(Decision()).forward_mps;
  };
  EXPECT_EQ(forward_mps(0.0), 1.5);
  EXPECT_EQ(forward_mps(0.1), 1.5) << "it looks 4 m ahead";
  for (const double curvature : {0.6, 0.8, 1.0, -1.0}) {
    const double seen_m =
        2.0 * params.steer.view_half_rad / std::abs(curvature) - params.robot.body.length_m / 2.0;
    EXPECT_LE(forward_mps(curvature), brake.stoppable_mps(seen_m)) << curvature;
    EXPECT_GE(forward_mps(curvature), brake.stoppable_mps(seen_m - 0.05)) << curvature;
    EXPECT_LT(forward_mps(curvature), 0.95 * brake.speed_limit(curvature, 1.5)) << curvature;
  }
  EXPECT_EQ(forward_mps(2.0), 0.0) << "not even the place before its front";
  EXPECT_EQ(planner.drive({0.04, 0.03}, now).value_or(Decision()).forward_mps, 0.04);
}

}  // namespace local_planner_test
}  // namespace nodmap::navigator
