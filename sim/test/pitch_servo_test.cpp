// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/pitch_servo.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nodmap::sim {
namespace pitch_servo_test {

TEST(PitchServo, ALongMovementIsATrapezoidOfSpeed) {
  PitchServo servo({});
  servo.set_goal({0.8, 1.0, 20.0}, 0.0);
  const double end_s = 0.8 / 1.0 + 1.0 / 20.0;
  EXPECT_NEAR(servo.at(end_s).pitch_rad, 0.8, 1e-12);
  EXPECT_EQ(servo.at(end_s + 1.0).pitch_rad, 0.8);
  EXPECT_EQ(servo.at(end_s + 1.0).rate_rad_s, 0.0);
  // In the middle of a symmetric movement, at full speed.
  EXPECT_NEAR(servo.at(0.5 * end_s).pitch_rad, 0.4, 1e-12);
  EXPECT_NEAR(servo.at(0.5 * end_s).rate_rad_s, 1.0, 1e-12);
  // While it accelerates: a t^2 / 2.
  EXPECT_NEAR(servo.at(0.03).pitch_rad, 0.5 * 20.0 * 0.03 * 0.03, 1e-12);
}

TEST(PitchServo, AShortMovementIsATriangleOfSpeed) {
  PitchServo servo({});
  servo.set_goal({-0.1, 3.0, 10.0}, 0.0);
  const double end_s = 2.0 * std::sqrt(0.1 / 10.0);
  EXPECT_NEAR(servo.at(0.5 * end_s).rate_rad_s, -std::sqrt(0.1 * 10.0), 1e-12);
  EXPECT_NEAR(servo.at(end_s).pitch_rad, -0.1, 1e-12);
}

TEST(PitchServo, NeverMovesBeyondItsLimits) {
  const ServoParams params;
  PitchServo servo(params);
  servo.set_goal({10.0, 100.0, 0.0}, 0.0);
  double fastest = 0.0;
  for (double t = 0.0; t < 2.0; t += 1e-3) {
    fastest = std::max(fastest, servo.at(t).rate_rad_s);
    EXPECT_LE(servo.at(t).pitch_rad, params.pitch_limit_rad + 1e-12);
  }
  EXPECT_NEAR(fastest, params.speed_rad_s, 1e-9);
  EXPECT_EQ(servo.at(2.0).pitch_rad, params.pitch_limit_rad);
}

TEST(PitchServo, ItMovesSmoothlyToAnyGoalGivenAtAnyTime) {
  std::mt19937_64 engine(3);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  };
  const ServoParams params;
  PitchServo servo(params);
  double t = 0.0;
  constexpr double kDt = 1e-4;
  PitchState before = servo.at(t);
  for (int goal = 0; goal < 500; ++goal) {
    const PitchGoal next{between(-1, 1), between(0.1, 6), between(5, 80)};
    servo.set_goal(next, t);
    for (const double end = t + between(0.0, 0.3); t < end; t += kDt) {
      const PitchState now = servo.at(t + kDt);
      // Rate and pitch must not jump.
      ASSERT_LE(std::abs(now.rate_rad_s - before.rate_rad_s),
                params.acceleration_rad_s2 * kDt + 1e-9);
      ASSERT_NEAR(now.pitch_rad - before.pitch_rad,
                  0.5 * (now.rate_rad_s + before.rate_rad_s) * kDt,
                  params.acceleration_rad_s2 * kDt * kDt);
      before = now;
    }
    EXPECT_EQ(servo.at(t + 60.0).pitch_rad, next.pitch_rad);
  }
}

TEST(PitchServo, WithoutTorqueItComesToRestAndIgnoresGoals) {
  PitchServo servo({});
  servo.set_goal({0.8, 1.0, 20.0}, 0.0);
  servo.set_torque(false, 0.4);
  const double rest = servo.at(5.0).pitch_rad;
  // It moves on for v^2 / 2a at the servo's own deceleration.
  EXPECT_NEAR(rest, servo.at(0.4).pitch_rad + 0.5 / ServoParams().acceleration_rad_s2, 1e-9);
  servo.set_goal({-0.5, 1.0, 20.0}, 5.0);
  EXPECT_EQ(servo.at(9.0).pitch_rad, rest);
  servo.set_torque(true, 9.0);
  EXPECT_EQ(servo.at(12.0).pitch_rad, rest);
  servo.set_goal({-0.5, 1.0, 20.0}, 12.0);
  EXPECT_EQ(servo.at(20.0).pitch_rad, -0.5);
}

TEST(PitchServo, JammedItStopsAndFreedItContinues) {
  PitchServo servo({});
  servo.set_goal({0.8, 1.0, 20.0}, 0.0);
  const double stuck = servo.at(0.3).pitch_rad;
  servo.set_jammed(true, 0.3);
  EXPECT_EQ(servo.at(0.3).rate_rad_s, 0.0);
  servo.set_goal({0.9, 1.0, 20.0}, 1.0);
  EXPECT_NEAR(servo.at(2.0).pitch_rad, stuck, 1e-12);
  servo.set_jammed(false, 2.0);
  EXPECT_NEAR(servo.at(2.0).pitch_rad, stuck, 1e-12);
  EXPECT_EQ(servo.at(4.0).pitch_rad, 0.9);
}

}  // namespace pitch_servo_test
}  // namespace nodmap::sim
