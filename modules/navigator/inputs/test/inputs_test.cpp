// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/inputs/inputs.hpp"

#include <gtest/gtest.h>

#include "modules/navigator/geofence.hpp"

namespace nodmap::navigator {
namespace inputs_test {

constexpr double kPi = geometry::kPi;

// At (1, 2), heading along y, in odom; the frame map is turned by 90 degrees and 10 m away.
Inputs inputs() {
  Inputs made;
  made.stamps.odometry = time::Timestamp(5s);
  made.odometry = {7, {1.0, 2.0, 0.5 * kPi}, 0.4, 0.1};
  made.map = {{1.0, 1.5, 0.5 * kPi}, {{2.0, 0.3}}};
  made.max_forward_mps = 1.2;
  made.sweep_count = 3;
  made.pose.T_map_odom = {10.0, 0.0, 0.5 * kPi};
  return made;
}

TEST(Inputs, TheSituationIsInBaseNow) {
  const Situation now = inputs().situation({});
  EXPECT_EQ(now.stamp, time::Timestamp(5s));
  EXPECT_EQ(now.forward_mps, 0.4);
  EXPECT_EQ(now.yaw_rate_rad_s, 0.1);
  EXPECT_EQ(now.max_forward_mps, 1.2);
  EXPECT_EQ(now.sweep_count, 3);
  EXPECT_FALSE(now.goal);
  ASSERT_EQ(now.points_base.size(), 1U);
  EXPECT_NEAR((now.points_base[0] - Eigen::Vector2d(1.5, 0.3)).norm(), 0.0, 1e-12)
      << "it has driven 0.5 m since the map was made";
}

TEST(Inputs, InANewOdomFrameAKnownPlaceInMapIsLost) {
  Inputs given = inputs();
  given.forget_odom_frame();
  EXPECT_FALSE(given.pose.is_lost) << "there was no pose: map and odom are the same";
  given.pose.stamp = time::Timestamp(5s);
  given.forget_odom_frame();
  EXPECT_TRUE(given.pose.is_lost);
  EXPECT_FALSE(given.pose.stamp);
}

// In map the robot is at (8, 1) and heads along -x.
TEST(Inputs, TheGoalIsSeenFromTheRobot) {
  Inputs given = inputs();
  given.goal = {{5.0, 3.0, 0.0}, 0.2, std::nullopt};
  Situation now = given.situation({});
  ASSERT_TRUE(now.goal);
  EXPECT_NEAR((now.goal->p_base - Eigen::Vector2d(3.0, -2.0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(now.goal->tolerance_m, 0.2);
  EXPECT_FALSE(now.goal->heading);
  given.goal->heading_tolerance_rad = 0.02;
  now = given.situation({});
  ASSERT_TRUE(now.goal->heading);
  EXPECT_NEAR(std::abs(now.goal->heading->yaw_rad), kPi, 1e-12);
  EXPECT_EQ(now.goal->heading->tolerance_rad, 0.02);
}

// Three standard deviations and the tolerance are 1.7 m.
TEST(Inputs, ADegradedPoseSlowsOnlyNearTheGoal) {
  DriveParams drive;
  drive.max_forward_mps = 1.5;
  Inputs given = inputs();
  given.pose.sigma_m = 0.5;
  const auto permitted_mps = [&](double goal_distance_m) {
    given.goal = {{8.0 + goal_distance_m, 1.0, 0.0}, 0.2, std::nullopt};
    return given.situation(drive).max_forward_mps;
  };
  EXPECT_EQ(permitted_mps(1.69), 1.2);
  given.pose.is_degraded = true;
  EXPECT_EQ(permitted_mps(1.69), 0.75);
  EXPECT_EQ(permitted_mps(1.71), 1.2);
  given.max_forward_mps = 0.5;
  EXPECT_EQ(permitted_mps(1.69), 0.5) << "the pitch controller's bound is lower";
}

TEST(Inputs, AGoalMayBeOutsideTheGeofence) {
  const Geofence fence("POLYGON((-2 -2, 2 -2, 2 2, -2 2))");
  Inputs given;
  EXPECT_EQ(given.goal_state(), GoalState::kNone);
  given.goal = {{3.0, 0.0, 0.0}, 0.2, std::nullopt};
  EXPECT_EQ(given.goal_state(), GoalState::kInside) << "there is no fence";
  given.geofence = &fence;
  EXPECT_EQ(given.goal_state(), GoalState::kOutsideFence);
  given.goal->T_map_goal.x = 1.0;
  EXPECT_EQ(given.goal_state(), GoalState::kInside);
}

TEST(Inputs, OfANewOdomFrameTheOldMapIsNotKnown) {
  Inputs given = inputs();
  given.stamps.map = given.stamps.scan = given.pose.stamp = time::Timestamp(5s);
  given.goal = {{5.0, 3.0, 0.0}, 0.2, std::nullopt};
  given.forget_odom_frame();
  EXPECT_FALSE(given.map || given.stamps.map || given.stamps.scan || given.pose.stamp);
  EXPECT_TRUE(given.goal) << "it is in the frame map";
}

}  // namespace inputs_test
}  // namespace nodmap::navigator
