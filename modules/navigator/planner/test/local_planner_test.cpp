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

}  // namespace local_planner_test
}  // namespace nodmap::navigator
