// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/speed_limiter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/robot/robot_params.hpp"
#include "drivers/kurt/odometry.hpp"

namespace nodmap::kurt {
namespace speed_limiter_test {

constexpr double kPeriodS = 0.01;

// Steps until the wheels have reached the command, or a minute has passed.
WheelSpeeds settle(SpeedLimiter& limiter, const DriveCommand& command) {
  for (int i = 0; i < 6000; ++i) {
    limiter.step(command, kPeriodS);
  }
  return limiter.current();
}

TEST(WheelSpeeds, KurtDriversFormula) {
  WheelParams params;
  params.steering = Steering::kKurtDriver;
  const WheelSpeeds wheels = wheel_speeds({0.5, 1.0}, params);
  EXPECT_DOUBLE_EQ(wheels.left_mps, 0.5 - 0.28);
  EXPECT_DOUBLE_EQ(wheels.right_mps, 0.5 + 0.28);
}

TEST(WheelSpeeds, APositiveTurnRateTurnsLeft) {
  const WheelSpeeds wheels = wheel_speeds({0.0, 1.0}, WheelParams{});
  EXPECT_LT(wheels.left_mps, 0.0);
  EXPECT_GT(wheels.right_mps, 0.0);
}

// The default steering: odometry measures on the wheels what DRIVE commanded.
TEST(WheelSpeeds, OdometryMeasuresTheCommand) {
  const WheelParams params;
  const DriveCommand command{0.8, -0.6};
  const WheelSpeeds wheels = wheel_speeds(command, params);
  const double ticks_per_mps = kPeriodS * params.ticks_per_revolution / params.perimeter_m;
  Odometry odometry(params, {});
  ASSERT_TRUE(odometry.add({static_cast<int>(std::lround(wheels.left_mps * ticks_per_mps)),
                            static_cast<int>(std::lround(wheels.right_mps * ticks_per_mps))}));
  // Half a tick of rounding is 0.9 mm/s.
  EXPECT_NEAR(odometry.state().forward_mps, command.forward_mps, 0.001);
  EXPECT_NEAR(odometry.state().yaw_rate_rad_s, command.yaw_rate_rad_s, 0.005);
}

TEST(SpeedLimiter, R6_NoWheelIsEverFasterThanTheRobot) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> speed(-20.0, 20.0);
  for (const double max_mps : {1.8, kTopSpeedMps}) {  // of the KURT3D; of the base
    SpeedLimiter limiter{WheelParams{}, SpeedLimits{.max_speed_mps = max_mps}};
    for (int i = 0; i < 100'000; ++i) {
      const WheelSpeeds wheels = limiter.step({speed(random), speed(random)}, kPeriodS);
      ASSERT_LE(std::abs(wheels.left_mps), max_mps);
      ASSERT_LE(std::abs(wheels.right_mps), max_mps);
    }
    const WheelSpeeds fastest = settle(limiter, {100.0, 0.0});
    EXPECT_DOUBLE_EQ(fastest.left_mps, max_mps);
    EXPECT_DOUBLE_EQ(fastest.right_mps, max_mps);
    const WheelSpeeds backwards = settle(limiter, {-100.0, 0.0});
    EXPECT_DOUBLE_EQ(backwards.left_mps, -max_mps);
    EXPECT_DOUBLE_EQ(backwards.right_mps, -max_mps);
  }
}

TEST(SpeedLimiter, SaturationKeepsTheCurvature) {
  const WheelSpeeds wheels = saturate({4.0, 8.0}, 5.2);
  EXPECT_DOUBLE_EQ(wheels.right_mps, 5.2);
  EXPECT_DOUBLE_EQ(wheels.left_mps, 2.6);
  const WheelSpeeds slow = saturate({-1.0, 2.0}, 5.2);
  EXPECT_EQ(slow.left_mps, -1.0);
  EXPECT_EQ(slow.right_mps, 2.0);
}

TEST(SpeedLimiter, AccelerationIsLimitedAndTheCurveKept) {
  const SpeedLimits limits;
  SpeedLimiter limiter(WheelParams{}, limits);
  const DriveCommand command{1.0, 0.5};
  const WheelSpeeds goal = wheel_speeds(command, WheelParams{});
  WheelSpeeds before;
  for (int i = 0; i < 200; ++i) {
    const WheelSpeeds wheels = limiter.step(command, kPeriodS);
    EXPECT_LE(wheels.right_mps - before.right_mps, limits.max_acceleration_mps2 * kPeriodS + 1e-12);
    EXPECT_NEAR(wheels.left_mps * goal.right_mps, wheels.right_mps * goal.left_mps, 1e-12);
    before = wheels;
  }
  EXPECT_DOUBLE_EQ(before.left_mps, goal.left_mps);
  EXPECT_DOUBLE_EQ(before.right_mps, goal.right_mps);
  // 1.1 m/s at 1.5 m/s^2
  limiter.stop();
  int steps = 0;
  while (limiter.step(command, kPeriodS).right_mps < goal.right_mps) {
    ++steps;
  }
  EXPECT_EQ(steps, static_cast<int>(goal.right_mps / limits.max_acceleration_mps2 / kPeriodS));
}

TEST(SpeedLimiter, BrakingOnCommandHasItsOwnLimit) {
  const SpeedLimits limits;
  SpeedLimiter limiter(WheelParams{}, limits);
  settle(limiter, {1.5, 0.0});
  double before_mps = 1.5;
  int steps = 0;
  while (limiter.current().left_mps > 0.0) {
    const double now_mps = limiter.step({0.0, 0.0}, kPeriodS).left_mps;
    EXPECT_LE(before_mps - now_mps, limits.max_deceleration_mps2 * kPeriodS + 1e-12);
    before_mps = now_mps;
    ++steps;
  }
  EXPECT_EQ(steps, 50);  // 1.5 m/s at 3 m/s^2
}

// The outer wheel has its limit, and the curve is kept: the centre decelerates by less, as the
// navigator's Brake expects.
TEST(SpeedLimiter, OnAnArcTheCentreBrakesByLess) {
  const SpeedLimits limits;
  const WheelParams wheels;
  const robot::Braking braking;
  // Rounded to centimetres.
  EXPECT_NEAR(braking.wheel_arm_m, 0.5 * wheels.axis_m / wheels.turning_adaptation, 0.005);
  for (const DriveCommand& command : {DriveCommand{1.5, 0.53}, {1.0, -0.8}, {0.57, 1.4}}) {
    SpeedLimiter limiter(wheels, limits);
    settle(limiter, command);
    double driven_m = 0.0;
    for (int i = 0; i < 200; ++i) {
      const WheelSpeeds now = limiter.step({0.0, 0.0}, kPeriodS);
      driven_m += 0.5 * (now.left_mps + now.right_mps) * kPeriodS;
    }
    const double curvature = std::abs(command.yaw_rate_rad_s) / command.forward_mps;
    // The distance of one step.
    EXPECT_NEAR(
        driven_m,
        command.forward_mps * command.forward_mps / (2.0 * braking.emergency_mps2(curvature)),
        command.forward_mps * kPeriodS);
  }
}

TEST(SpeedLimiter, BackwardsTheLimitsAreTheSame) {
  const SpeedLimits limits;
  SpeedLimiter limiter(WheelParams{}, limits);
  const auto steps_until = [&limiter](double target_mps, double reached_mps) {
    const double sign = reached_mps > limiter.current().left_mps ? 1.0 : -1.0;
    int steps = 0;
    while (sign * (reached_mps - limiter.current().left_mps) > 1e-9) {  // rounding
      limiter.step({target_mps, 0.0}, kPeriodS);
      ++steps;
    }
    return steps;
  };
  EXPECT_EQ(steps_until(-1.5, -1.5), 100);  // 1.5 m/s at 1.5 m/s^2
  EXPECT_EQ(steps_until(1.5, 0.0), 50);     // a reversal brakes at 3 m/s^2
  EXPECT_EQ(steps_until(1.5, 1.5), 100);
}

TEST(SpeedLimiter, GoesOnFromAMeasuredMotionButNotFaster) {
  SpeedLimiter limiter{WheelParams{}, SpeedLimits{}};
  settle(limiter, {1.5, 0.0});
  limiter.start_from({10.0, 0.0});  // a damaged frame
  EXPECT_DOUBLE_EQ(limiter.current().left_mps, 1.5);
  limiter.start_from({0.7, 0.0});
  EXPECT_DOUBLE_EQ(limiter.current().left_mps, 0.7);
  EXPECT_DOUBLE_EQ(limiter.current().right_mps, 0.7);
  limiter.stop();
  limiter.start_from({0.7, 0.3});
  EXPECT_EQ(limiter.current().left_mps, 0.0);
}

// With this steering odometry does not measure the commanded yaw rate.
TEST(SpeedLimiter, GoesOnFromAMeasuredRotationAlsoWithKurtDriversSteering) {
  WheelParams wheels;
  wheels.steering = Steering::kKurtDriver;
  SpeedLimiter limiter(wheels, SpeedLimits{});
  settle(limiter, {0.5, 1.0});
  Odometry odometry(wheels, {});
  ASSERT_TRUE(odometry.add({100, 200}));
  limiter.start_from({odometry.state().forward_mps, odometry.state().yaw_rate_rad_s});
  const double mps_per_tick = wheels.perimeter_m / wheels.ticks_per_revolution / kPeriodS;
  EXPECT_NEAR(limiter.current().left_mps, 100 * mps_per_tick, 1e-12);
  EXPECT_NEAR(limiter.current().right_mps, 200 * mps_per_tick, 1e-12);
}

TEST(SpeedLimiter, AStopForSafetyIsAtOnce) {
  SpeedLimiter limiter{WheelParams{}, SpeedLimits{}};
  settle(limiter, {1.5, 0.3});
  limiter.stop();
  EXPECT_EQ(limiter.current().left_mps, 0.0);
  EXPECT_EQ(limiter.current().right_mps, 0.0);
}

}  // namespace speed_limiter_test
}  // namespace nodmap::kurt
