// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/goal_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace goal_drive_test {

constexpr double kStepS = 0.01332;

// A local map of a square fence of 2.2 m with a gap ahead, seen from the robot in its middle. It
// looks to so many sides, and behind first.
LocalMap fenced(double gap_m = 0.0, int num_sides = 4) {
  LocalMap map({}, {});
  for (int quarter = 2; quarter < 2 + num_sides; ++quarter) {
    test::sweep(map, test::fence(gap_m), {0.0, 0.0, 0.5 * geometry::kPi * quarter});
  }
  return map;
}

TEST(GoalDrive, WithoutAPathItLooksAroundOnceAndThenStaysWithAReason) {
  const LocalMap map = fenced();
  GoalDrive drive({});
  const SeenDirections seen(SteerParams{});
  Situation now;
  now.seen = &seen;
  now.local_map = &map;
  now.max_forward_mps = 1.0;
  double rotated_rad = 0.0;
  Decision decision;
  for (int i = 0; i < 1500; ++i) {  // 20 s
    now.stamp = time::Timestamp(time::from_seconds(kStepS * i));
    now.goal = GoalInBase{now.T_odom_base.inverse() * Eigen::Vector2d(4.0, 0.0), 0.3};
    now.points_base = map.points_base(now.T_odom_base, 2.5);
    decision = drive.decide(now);
    EXPECT_EQ(decision.forward_mps, 0.0);
    now.yaw_rate_rad_s = decision.yaw_rate_rad_s;
    now.T_odom_base.yaw += kStepS * decision.yaw_rate_rad_s;
    rotated_rad += kStepS * std::abs(decision.yaw_rate_rad_s);
  }
  EXPECT_EQ(decision.reason, Reason(Why::kNoPath));
  EXPECT_EQ(decision.yaw_rate_rad_s, 0.0);
  // One full rotation. It may begin or end a step of 0.7 degrees earlier or later.
  EXPECT_NEAR(rotated_rad, 2.0 * geometry::kPi, 0.05);
}

// A local map of free floor, seen all around.
LocalMap open_floor() {
  LocalMap map({}, {});
  test::look_around(map, {});
  return map;
}

// A robot on that floor, which follows each decision as fast as its wheels can.
class Driver {
 public:
  explicit Driver(const LocalMap& map, double x_m = 0.0, double max_forward_mps = 1.0) {
    show(map);
    now_.seen = &seen_;
    now_.max_forward_mps = max_forward_mps;
    now_.T_odom_base.x = x_m;
  }

  // From now on the local map is this one.
  void show(const LocalMap& map) { now_.local_map = &map; }
  // The goal has this heading in odom.
  void set_heading(std::optional<double> yaw_rad) { heading_rad_ = yaw_rad; }
  void set_people(const People& people_base) { now_.people = people_base; }

  const Situation& now() const { return now_; }
  std::vector<Eigen::Vector2d> path() const {
    return drive_.path_map(now_.T_odom_base, goal_).value_or(std::vector<Eigen::Vector2d>());
  }
  void set_motion(const Twist& motion) {
    now_.forward_mps = motion.forward_mps;
    now_.yaw_rate_rad_s = motion.yaw_rate_rad_s;
  }
  // Nothing is decided for this long.
  void pause(time::Duration duration) { now_.stamp += duration; }

  Decision decide(const Eigen::Vector2d& goal_odom, double tolerance_m) {
    now_.stamp += time::from_seconds(kStepS);
    now_.goal = GoalInBase{now_.T_odom_base.inverse() * goal_odom, tolerance_m};
    if (heading_rad_) {
      now_.goal->heading = {*heading_rad_ - now_.T_odom_base.yaw, geometry::deg_to_rad(1.0)};
    }
    goal_ = {goal_odom.x(), goal_odom.y(), 0.0};
    seen_.update(now_.T_odom_base.yaw, 2 * num_steps_++);
    return drive_.decide(now_);
  }

  Decision step(const Eigen::Vector2d& goal_odom, double tolerance_m) {
    const Decision decision = decide(goal_odom, tolerance_m);
    const Twist twist = after({now_.forward_mps, now_.yaw_rate_rad_s},
                              {decision.forward_mps, decision.yaw_rate_rad_s}, kStepS, {});
    now_.forward_mps = twist.forward_mps;
    now_.yaw_rate_rad_s = twist.yaw_rate_rad_s;
    now_.T_odom_base = now_.T_odom_base * geometry::SE2{kStepS * twist.forward_mps, 0.0,
                                                        kStepS * twist.yaw_rate_rad_s};
    return decision;
  }

 private:
  GoalDrive drive_{NavigatorParams{}};
  SeenDirections seen_{SteerParams{}};
  Situation now_;
  std::optional<double> heading_rad_;
  geometry::SE2 goal_;  // of the last decision; map is odom
  std::int64_t num_steps_ = 0;
};

// At most 1500, which is 20 s.
int steps_until_arrival(Driver& driver, const Eigen::Vector2d& goal, double tolerance_m) {
  int num_steps = 0;
  while ((driver.now().T_odom_base.translation() - goal).norm() > tolerance_m && num_steps < 1500) {
    (void)driver.step(goal, tolerance_m);
    ++num_steps;
  }
  return num_steps;
}

// The slowest rollout is 0.2 m long and leads past a nearer goal. A cell of the plan is as large as
// the tolerance. Measured: up to 238 steps, 3.2 s.
TEST(GoalDrive, ArrivesAtAGoalThatIsNearerThanTheShortestRollout) {
  constexpr double kToleranceM = 0.05;
  const LocalMap map = open_floor();
  for (const double distance_m : {0.053, 0.08, 0.15}) {
    for (int k = 0; k < 8; ++k) {
      const double bearing_rad = 0.1 + 0.25 * geometry::kPi * k;
      const Eigen::Vector2d goal(distance_m * std::cos(bearing_rad),
                                 distance_m * std::sin(bearing_rad));
      Driver driver(map);
      const int num_steps = steps_until_arrival(driver, goal, kToleranceM);
      EXPECT_LT(num_steps, 305) << distance_m << " m away at " << geometry::rad_to_deg(bearing_rad)
                                << " degrees";
    }
  }
}

// It turns round the goal, millimetres outside of the tolerance, and in each decision there are
// rollouts that reach it later. Measured: up to 42 steps; it circles if it may come later and
// later.
TEST(GoalDrive, DoesNotCircleRoundAGoalBesideIt) {
  constexpr double kToleranceM = 0.15;
  constexpr double kRadiusM = 0.16;
  const LocalMap map = open_floor();
  for (const Eigen::Vector2d& goal : {Eigen::Vector2d(0.0, -0.152), Eigen::Vector2d(0.0, -0.16)}) {
    for (const double forward_mps : {0.075, 0.12}) {
      Driver driver(map, 0.0, 0.2);
      for (int i = 0; i < 30; ++i) {  // until there is a plan
        (void)driver.decide(goal, kToleranceM);
      }
      driver.set_motion({forward_mps, -forward_mps / kRadiusM});
      const int num_steps = steps_until_arrival(driver, goal, kToleranceM);
      EXPECT_LT(num_steps, 150) << goal.y() << " m, " << forward_mps << " m/s";
    }
  }
}

// The goal is behind the robot, and so is the staging place of a dock there.
TEST(GoalDrive, RotatesMoreSlowlyOnItsWayToADock) {
  const LocalMap map = open_floor();
  const auto fastest_rotation = [&](std::optional<double> heading_rad) {
    Driver driver(map);
    driver.set_heading(heading_rad);
    double fastest_rad_s = 0.0;
    for (int i = 0; i < 150; ++i) {  // 2 s
      const Decision decision = driver.step({-1.5, 0.0}, 0.1);
      if (decision.forward_mps == 0.0) {
        fastest_rad_s = std::max(fastest_rad_s, std::abs(decision.yaw_rate_rad_s));
      }
    }
    return fastest_rad_s;
  };
  const NavigatorParams params;
  EXPECT_GT(fastest_rotation(std::nullopt), params.docking.rotation_rad_s);
  EXPECT_DOUBLE_EQ(fastest_rotation(geometry::kPi), params.docking.rotation_rad_s);
}

// The explorer sends goal after goal.
TEST(GoalDrive, DoesNotBrakeWhenItGetsANewGoal) {
  const LocalMap map = open_floor();
  Driver driver(map);
  for (int i = 0; i < 200 && driver.now().forward_mps < 0.4; ++i) {
    (void)driver.step({3.0, 0.0}, 0.3);
  }
  ASSERT_GE(driver.now().forward_mps, 0.4);
  ASSERT_LT(driver.now().T_odom_base.x, 1.5);
  Decision decision = driver.step({3.0, 1.0}, 0.3);
  for (int i = 0; i < 60; ++i) {  // 0.8 s, more than planning takes
    EXPECT_NE(decision.reason, Reason(Why::kPlans));
    decision = driver.step({3.0, 1.0}, 0.3);
    // Of the robot: near the end of the floor that it has seen, single decisions are slower.
    EXPECT_GE(driver.now().forward_mps, 0.4) << "step " << i;
  }
}

// The robot has almost arrived at the previous goal, so there is no way to go on towards it.
TEST(GoalDrive, CloseToThePreviousGoalItSlowsDownUntilThereIsANewPlan) {
  const LocalMap map = open_floor();
  Driver driver(map);
  for (int i = 0; i < 1000 && driver.now().T_odom_base.x < 0.7; ++i) {
    (void)driver.step({1.1, 0.0}, 0.3);
  }
  ASSERT_GE(driver.now().T_odom_base.x, 0.7);
  const double former_mps = driver.now().forward_mps;
  const Decision decision = driver.step({0.0, 1.1}, 0.3);
  EXPECT_EQ(decision.reason, Reason(Why::kPlans));
  EXPECT_NEAR(decision.forward_mps, former_mps - 0.105, 1e-12) << "ordinary brakes for 0.07 s";
}

// The time in which the robot is stopped is no time without progress: the path stays where it is.
TEST(GoalDrive, APauseBetweenItsDecisionsIsNoFailureOfThePath) {
  const LocalMap map = open_floor();
  Driver driver(map);
  const auto plan = [&] {
    for (int i = 0; i < 60; ++i) {  // 0.8 s, so that there is a new plan
      (void)driver.decide({3.0, 0.0}, 0.3);
    }
    return driver.path();
  };
  const std::vector<Eigen::Vector2d> before = plan();
  EXPECT_GT(before.size(), 3U);
  driver.pause(100s);
  EXPECT_EQ(plan(), before);
}

// Lets the robot decide for so many seconds, without moving. Returns how long it has reported, at
// the end of them, that there is no path.
double seconds_without_path(Driver& driver, double duration_s) {
  double without_s = 0.0;
  for (double time_s = 0.0; time_s < duration_s; time_s += kStepS) {
    const Reason reason = driver.decide({3.0, 0.0}, 0.3).reason;
    const bool has_none = reason == Reason(Why::kNoPath) || reason == Reason(Why::kNoPathLooks);
    without_s = has_none ? without_s + kStepS : 0.0;
  }
  return without_s;
}

// Nobody knows how long people stand in a door. The grid leaves less than the least clearance in
// it, so a failure would close it.
TEST(GoalDrive, ADoorInWhichThereArePeopleIsNotGivenUp) {
  const LocalMap map = fenced(0.45);
  Driver driver(map, 0.6);
  ASSERT_EQ(seconds_without_path(driver, 1.0), 0.0);
  driver.set_people({{{0.6, 0.0}, {0.1, 0.0}, 0.25, 0.1, 0.1}});
  EXPECT_EQ(seconds_without_path(driver, 30.0), 0.0);
  driver.set_people({});
  EXPECT_EQ(seconds_without_path(driver, 10.0), 0.0);
}

// The robot is held where it is for longer than its patience of 12 s. The 30 s are the time until
// it looks around again.
TEST(GoalDrive, ADoorThatWasGivenUpIsTriedAgainAfterHalfAMinute) {
  const LocalMap map = fenced(0.45);
  Driver driver(map, 0.6);
  EXPECT_GT(seconds_without_path(driver, 14.0), 0.5);
  EXPECT_GT(seconds_without_path(driver, 25.0), 25.0);
  EXPECT_EQ(seconds_without_path(driver, 6.0), 0.0);
}

// After the first look around the robot doubts what it remembers, and then the side that it does
// not see seems to be open. It must not do this again and again.
TEST(GoalDrive, AClosedRoomThatSeemedOpenOnceHasNoPathForHalfAMinute) {
  const LocalMap closed = fenced();
  const LocalMap open = fenced(0.0, 1);
  Driver driver(closed);
  const auto turn_for = [&](double duration_s) {
    Decision decision;
    for (double time_s = 0.0; time_s < duration_s; time_s += kStepS) {
      decision = driver.step({3.0, 0.0}, 0.3);
    }
    return decision.reason;
  };
  ASSERT_EQ(turn_for(12.0), Reason(Why::kNoPathLooks));
  driver.show(open);
  (void)turn_for(1.5);
  ASSERT_EQ(seconds_without_path(driver, 0.5), 0.0);
  driver.show(closed);
  ASSERT_GT(seconds_without_path(driver, 0.9), 0.0);
  ASSERT_EQ(turn_for(12.0), Reason(Why::kNoPathLooks));
  driver.show(open);
  (void)turn_for(2.0);
  EXPECT_GT(seconds_without_path(driver, 12.0), 11.9);
}

// The wall ahead is from 1.0 m on. The goal is moved off it by less than its tolerance.
TEST(GoalDrive, AGoalIsCorrectedByLessThanItsTolerance) {
  const LocalMap map = fenced();
  Driver driver(map);
  for (int i = 0; i < 150; ++i) {
    ASSERT_EQ(driver.decide({1.1, 0.0}, 0.2).forward_mps, 0.0);
  }
  for (int i = 0; i < 100; ++i) {
    (void)driver.step({0.93, 0.0}, 0.2);
  }
  EXPECT_GT(driver.now().T_odom_base.x, 0.05);
}

// For the first goal the robot has looked around already, and would not again for half a minute.
TEST(GoalDrive, ForANewGoalWithoutAPathItLooksAroundAtOnce) {
  const LocalMap map = fenced();
  Driver driver(map);
  for (int i = 0; i < 1500; ++i) {  // 20 s
    (void)driver.step({3.0, 0.0}, 0.3);
  }
  ASSERT_EQ(driver.step({3.0, 0.0}, 0.3).reason, Reason(Why::kNoPath));
  for (int i = 0; i < 200; ++i) {
    (void)driver.step({-3.0, 0.0}, 0.3);
  }
  EXPECT_EQ(driver.step({-3.0, 0.0}, 0.3).reason, Reason(Why::kNoPathLooks));
}

}  // namespace goal_drive_test
}  // namespace nodmap::navigator
