// SPDX-License-Identifier: BSD-3-Clause
// The speed bound of the controller in closed loop with a servo.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "modules/pitch_controller/test/control_loop.hpp"

namespace nodmap::pitch_controller {
namespace controller_bound_test {

using test::Loop;

TEST(PitchControllerBound, TheTopSpeedIsNeverExceeded) {
  for (const Mode mode : {Mode::kNodding, Mode::kFixed}) {
    PitchControllerParams params;
    params.mode = mode;
    params.speed.top_mps = 0.4;
    Loop loop(params);
    loop.run(5.0, 0.5);
    EXPECT_EQ(loop.decision.max_forward_mps, 0.4);
  }
}

// The laser looks the other way.
TEST(PitchControllerBound, BackwardsTheBoundIsThatOfAStationaryRobot) {
  Loop loop;
  loop.run(5.0, 0.0);
  const double stationary_mps = loop.decision.max_forward_mps;
  loop.run(5.0, -1.0);
  EXPECT_NEAR(loop.decision.max_forward_mps, stationary_mps, 1e-3);  // of half a millimetre
}

TEST(PitchControllerBound, TheBoundFollowsTheMeasuredSweepsNotThePlan) {
  // A weak servo without regulation: the plan is the same, but the bound is lower.
  PitchControllerParams off;
  off.regulator = {0.0, 0.0};
  off.speed.top_mps = 5.0;
  Loop good(off);
  good.run(10.0, 1.5);
  Loop weak(off);
  weak.head.speed_gain = 0.25;
  weak.run(10.0, 1.5);
  EXPECT_EQ(weak.dut.plan().sweep_s, good.dut.plan().sweep_s);
  EXPECT_LT(weak.decision.max_forward_mps, good.decision.max_forward_mps - 0.2);
}

// Lines of a servo that is too fast are farther apart; one that stops short does not look as near.
// Measured: 1.69, 1.06 and 1.49 m/s.
TEST(PitchControllerBound, TheBoundFollowsTheMeasuredRateAndEndsNotThePlan) {
  PitchControllerParams off;
  off.regulator = {0.0, 0.0};
  off.speed.top_mps = 5.0;
  const auto bound_with = [&](double speed_gain, double short_rad) {
    Loop loop(off);
    loop.head.speed_gain = speed_gain;
    loop.head.short_rad = short_rad;
    loop.run(10.0, 1.5);
    return loop.decision.max_forward_mps;
  };
  const double good_mps = bound_with(1.0, 0.0);
  EXPECT_LT(bound_with(1.5, 0.0), good_mps - 0.3);
  EXPECT_LT(bound_with(1.0, 0.03), good_mps - 0.1);
}

// A stationary robot is pushed, or its wheels are: it comes nearer to what may have appeared, and
// during the first sweep the laser has not measured it.
TEST(PitchControllerBound, TheBoundFallsOnTheWayToWhatMayHaveAppeared) {
  Loop loop;
  loop.run(8.0, 0.0);
  loop.run(0.02, 1.0);
  for (int i = 0; i < 12; ++i) {
    const double before_mps = loop.decision.max_forward_mps;
    loop.run(0.02, 1.0);
    EXPECT_LT(loop.decision.max_forward_mps, before_mps) << i;
  }
}

// A robot on a short arc, whose arc becomes long, or whose navigator falls silent: the sweeps
// become longer only as its speed allows it, and after a while they are those by speed again.
TEST(PitchControllerBound, LongerSweepsForAnotherViewDoNotMakeTheRobotBrake) {
  PitchControllerParams params;
  params.follows_path = true;
  for (const bool falls_silent : {false, true}) {
    Loop loop(params);
    loop.free_m = 0.0;
    const auto as_permitted = [&] {
      return std::min({1.5, loop.speed + 0.015, loop.decision.max_forward_mps});
    };
    loop.run(3.5, 0.0);
    loop.run(3.0, as_permitted);
    const SweepPlan short_view = loop.dut.plan();
    loop.free_m = falls_silent ? std::nullopt : std::optional(100.0);
    for (int i = 0; i < 300; ++i) {
      const double before_mps = loop.speed;
      loop.run(0.01, as_permitted);
      EXPECT_GE(loop.speed, before_mps - 0.01) << falls_silent << " " << i;
    }
    const SweepPlan by_speed =
        SweepPlanner(params.robot, params.detection, params.speed.fast_mps).plan(loop.speed);
    EXPECT_NEAR(loop.dut.plan().sweep_s, by_speed.sweep_s, 0.01 * by_speed.sweep_s) << falls_silent;
    EXPECT_LT(short_view.sweep_s, 0.95 * by_speed.sweep_s) << falls_silent;
  }
}

// Wheels that lock tell nothing about the robot.
TEST(PitchControllerBound, ThePlanClosesNoFasterThanTheRobotCanBrake) {
  const PitchControllerParams params;
  Loop loop;
  loop.run(5.0, 1.5);
  loop.run(0.5, 0.0);
  const double least_mps = 1.5 - 0.5 * params.robot.braking.deceleration_mps2;
  EXPECT_GE(loop.dut.plan().d_min_m,
            params.robot.braking.required_distance_m(least_mps, params.detection.processing_s));
}

}  // namespace controller_bound_test
}  // namespace nodmap::pitch_controller
