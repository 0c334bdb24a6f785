// SPDX-License-Identifier: BSD-3-Clause
// Docking without obstacles, in closed loop with a unicycle that drives exactly at the commanded
// speeds.
#include "modules/navigator/planner/docking.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace nodmap::navigator {
namespace docking_test {

using geometry::deg_to_rad;
using Kind = DockingStep::Kind;

constexpr double kStepS = 0.01332;
constexpr double kToleranceM = 0.02;
constexpr double kToleranceRad = deg_to_rad(1.0);

// A robot at `T_goal_base` and the docking that drives it. Where docking asks for a plan, the
// robot is set down at the border of the staging place: the planner is not tested here.
struct Dock {
  explicit Dock(const geometry::SE2& start) : T_goal_base(start) {}

  geometry::SE2 T_goal_base;
  Docking docking{DockingParams{}};
  DockingStep step;
  double time_s = 0.0;
  int num_plans = 0;
  // What the wheels do, as a fraction of the commanded speeds.
  double forward_ratio = 1.0;
  double yaw_ratio = 1.0;
  // Error of the pose that docking is given.
  geometry::SE2 pose_error{};

  void cycle() {
    const geometry::SE2 T_base_goal = (T_goal_base * pose_error).inverse();
    GoalInBase goal{T_base_goal.translation(), kToleranceM};
    goal.heading = {T_base_goal.yaw, kToleranceRad};
    step = docking.next(goal, time::Timestamp(time::from_seconds(time_s)));
    if (step.kind == Kind::kPlan) {
      ++num_plans;
      const Eigen::Vector2d staging_goal = (T_goal_base * pose_error) * step.staging_base;
      EXPECT_LT((staging_goal - Eigen::Vector2d(-DockingParams{}.staging_m, 0.0)).norm(), 1e-9);
      T_goal_base =
          geometry::SE2{staging_goal.x(), staging_goal.y() + 0.9 * Docking::kStagingToleranceM,
                        deg_to_rad(60.0)} *
          pose_error.inverse();
    } else if (step.kind == Kind::kMove) {
      const double rotation_rad = kStepS * yaw_ratio * step.yaw_rate_rad_s;
      const double length_m = kStepS * forward_ratio * step.forward_mps;
      T_goal_base =
          T_goal_base * geometry::SE2{length_m * std::cos(0.5 * rotation_rad),
                                      length_m * std::sin(0.5 * rotation_rad), rotation_rad};
    }
    time_s += kStepS;
  }

  void run_until(Kind kind, double at_most_s) {
    for (cycle(); step.kind != kind && time_s < at_most_s; cycle()) {
    }
    EXPECT_EQ(step.kind, kind) << "after " << time_s << " s: " << to_text(step.reason);
  }
};

TEST(Docking, DocksAtTheFirstTryFromAnyHeading) {
  for (const double yaw_deg : {0.0, 170.0, -90.0}) {
    Dock dock({-3.0, 2.0, deg_to_rad(yaw_deg)});
    // It drives 0.8 m at 0.15 m/s, the last part at 0.05 m/s, and rotates twice.
    dock.run_until(Kind::kDocked, 25.0);
    EXPECT_EQ(dock.num_plans, 1);
    // It stops 3 mm early. It is 13 cm aside at the staging place; after (0.8 - 0.1) / 0.12 decay
    // lengths less than 1 cm of that remains.
    EXPECT_LT(dock.T_goal_base.translation().norm(), 0.01);
    EXPECT_LT(std::abs(dock.T_goal_base.yaw), 0.5 * kToleranceRad);
  }
}

TEST(Docking, DocksWithinToleranceWithBiasedWheels) {
  Dock dock({-2.0, 0.0, 0.0});
  dock.forward_ratio = 0.95;
  dock.yaw_ratio = 1.1;
  dock.run_until(Kind::kDocked, 25.0);
  EXPECT_LT(dock.T_goal_base.translation().norm(), kToleranceM);
}

TEST(Docking, BacksOffAndTriesAgainWhenThePoseTurnsOutToBeWrongSideways) {
  Dock dock({-2.0, 0.0, 0.0});
  dock.pose_error = {0.0, 0.06, 0.0};
  while (std::abs(dock.T_goal_base.x) > 0.01 || dock.step.kind != Kind::kStay) {
    dock.cycle();
    ASSERT_LT(dock.time_s, 25.0);
  }
  dock.pose_error = {};
  bool backed_off = false;
  while (dock.step.kind != Kind::kDocked) {
    dock.cycle();
    backed_off |= dock.step.forward_mps < 0.0;
    ASSERT_LT(dock.time_s, 60.0);
  }
  EXPECT_TRUE(backed_off);
  EXPECT_LT(dock.T_goal_base.translation().norm(), kToleranceM);
}

TEST(Docking, StaysDockedUntilItsPoseIsClearlyElsewhere) {
  Dock dock({-2.0, 0.0, 0.0});
  dock.run_until(Kind::kDocked, 25.0);
  dock.pose_error = {0.0, 0.1, deg_to_rad(8.0)};
  dock.cycle();
  EXPECT_EQ(dock.step.kind, Kind::kDocked);
  dock.pose_error = {0.0, 0.15, 0.0};
  dock.cycle();
  EXPECT_EQ(dock.step.kind, Kind::kPlan);
}

// The wheels do not move, so no correction brings the robot nearer.
TEST(Docking, GivesUpAfterFiveTriesAndBeginsAgainLater) {
  Dock dock({-2.0, 0.0, 0.0});
  dock.run_until(Kind::kMove, 1.0);
  dock.forward_ratio = 0.0;
  dock.yaw_ratio = 0.0;
  // Five tries, each given up after 25 s.
  dock.run_until(Kind::kFailed, 5 * 26.0 + 1.0);
  EXPECT_TRUE(dock.docking.has_failed());
  dock.forward_ratio = 1.0;
  dock.yaw_ratio = 1.0;
  dock.run_until(Kind::kDocked, dock.time_s + 60.0 + 25.0);
}

// The wheels never move. Each round has five tries of 25 s, however often it has failed before.
TEST(Docking, HasAllItsTriesAfterEachFailure) {
  Dock dock({-DockingParams{}.staging_m, 0.0, deg_to_rad(60.0)});
  dock.forward_ratio = 0.0;
  dock.yaw_ratio = 0.0;
  for (int round = 0; round < 3; ++round) {
    const double began_s = dock.time_s;
    dock.run_until(Kind::kFailed, began_s + 300.0);
    // Each of the tries and plans begins with the decision after the last one.
    EXPECT_NEAR(dock.time_s - began_s, 5 * 25.0, 15 * kStepS) << "round " << round;
    dock.run_until(Kind::kMove, dock.time_s + 61.0);
  }
}

// Somebody has pressed the stop: the robot has had less time than the 25 s of a phase.
TEST(Docking, APauseBetweenItsDecisionsDoesNotMakeItLate) {
  Dock dock({-2.0, 0.0, 0.0});
  for (int i = 0; i < 4; ++i) {
    dock.time_s += 100.0;
    dock.run_until(Kind::kMove, dock.time_s + 1.0);
  }
  dock.run_until(Kind::kDocked, dock.time_s + 25.0);
  EXPECT_EQ(dock.num_plans, 1);
}

}  // namespace docking_test
}  // namespace nodmap::navigator
