// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/base_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::kurt {
namespace base_guard_test {

constexpr DriveCommand kFast{1.5, 0.5};

RangeReadings sonar(int raw) {
  return {.infrared_raw = {}, .sonar_raw = raw};
}

RangeReadings infrared(Infrared sensor, int raw) {
  RangeReadings readings;
  readings.infrared_raw[static_cast<std::size_t>(sensor)] = raw;
  return readings;
}

RangeReadings infrared_back(int raw) {
  return infrared(Infrared::kBack, raw);
}

// The sonar's raw reading at this range: the inverse of the sensor's formula.
int sonar_raw(double range_m) {
  return static_cast<int>(std::lround((100.0 * range_m - 11.9231) / 0.110652));
}

class BaseGuardTest : public ::testing::Test {
 protected:
  GuardParams params_;
  SpeedLimits limits_;
  BaseGuard guard_{params_, limits_};
  time::SteadyTime now_{10s};
};

TEST_F(BaseGuardTest, WithoutReadingsNothingIsSlowed) {
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
  guard_.add(sonar(1100), now_);  // nothing within its range
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
}

// Oracle: a drive at the limit for one reaction time, then braking at half of the wheels'
// deceleration.
TEST_F(BaseGuardTest, FromThePermittedSpeedTheRobotStopsBeforeTheObstacle) {
  for (const double range_m : {0.3, 0.4, 0.6, 0.9, 1.2}) {
    guard_.add(sonar(sonar_raw(range_m)), now_);
    const double speed_mps = guard_.limit({5.0, 0.0}, now_).forward_mps;
    const double deceleration = 0.5 * limits_.max_deceleration_mps2;
    double driven_m = 0.1 * speed_mps;
    for (double v = speed_mps; v > 0.0; v -= 1e-4 * deceleration) {
      driven_m += 1e-4 * v;
    }
    // 1 mm: a raw reading is 1.1 mm, rounded.
    EXPECT_NEAR(driven_m, range_m - params_.near_m, 1e-3) << range_m;
  }
}

TEST_F(BaseGuardTest, TheCurvatureStays) {
  guard_.add(sonar(sonar_raw(0.5)), now_);
  const DriveCommand limited = guard_.limit(kFast, now_);
  EXPECT_LT(limited.forward_mps, kFast.forward_mps);
  EXPECT_NEAR(limited.yaw_rate_rad_s / limited.forward_mps,
              kFast.yaw_rate_rad_s / kFast.forward_mps, 1e-12);
}

TEST_F(BaseGuardTest, NearItCreepsAndMayStillRotateAndBackOut) {
  guard_.add(sonar(sonar_raw(0.24)), now_);
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, params_.creep_mps);
  EXPECT_EQ(guard_.limit({0.0, 2.0}, now_).yaw_rate_rad_s, 2.0);
  EXPECT_EQ(guard_.limit({-0.5, 0.0}, now_).forward_mps, -0.5);
  // Nearer than the sonar can measure it reads less.
  guard_.add(sonar(50), now_);
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, params_.creep_mps);
  guard_.add(sonar(1100), now_);
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
}

// A person steps in front of it: the next reading is below what the sonar can measure.
TEST_F(BaseGuardTest, AnObstacleThatApproachesWithinAReadingMakesItCreep) {
  for (const double last_seen_m : {0.24, 0.27, 0.39}) {
    guard_.add(sonar(sonar_raw(last_seen_m)), now_);
    for (int i = 0; i < 3; ++i) {
      guard_.add(sonar(50), now_);
      EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, params_.creep_mps) << last_seen_m;
    }
  }
  // A sonar that reads this although nothing was near is none.
  guard_.add(sonar(sonar_raw(1.0)), now_);
  guard_.add(sonar(50), now_);
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
}

TEST_F(BaseGuardTest, BehindTheInfraredCounts) {
  guard_.add(infrared_back(900), now_);  // nearer than it can measure
  EXPECT_EQ(guard_.limit({-1.0, 0.0}, now_).forward_mps, -params_.creep_mps);
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
  guard_.add(infrared_back(60), now_);  // nothing there
  EXPECT_EQ(guard_.limit({-1.0, 0.0}, now_).forward_mps, -1.0);
}

TEST_F(BaseGuardTest, SomethingAtAFrontCornerMakesItCreepAhead) {
  for (const Infrared sensor : {Infrared::kLeftFront, Infrared::kRightFront}) {
    guard_.add(infrared(sensor, 790), now_);  // 3.5 cm away, beside its way
    EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
    guard_.add(infrared(sensor, 900), now_);  // nearer than it can measure
    EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, params_.creep_mps);
    EXPECT_EQ(guard_.limit({-1.0, 0.0}, now_).forward_mps, -1.0);
    guard_.add(sonar(1100), now_);  // the other frame's sensors say nothing about it
    EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, params_.creep_mps);
    EXPECT_EQ(guard_.limit(kFast, now_ + 501ms).forward_mps, kFast.forward_mps);
    guard_.add(infrared(sensor, 60), now_);  // nothing there
    EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
  }
}

TEST_F(BaseGuardTest, AnOldReadingDoesNotCount) {
  guard_.add(sonar(sonar_raw(0.24)), now_);
  EXPECT_EQ(guard_.limit(kFast, now_ + 500ms).forward_mps, params_.creep_mps);
  EXPECT_EQ(guard_.limit(kFast, now_ + 501ms).forward_mps, kFast.forward_mps);
}

TEST_F(BaseGuardTest, OnRequestRangesDoNotCount) {
  GuardParams without = params_;
  without.use_ranges = false;
  BaseGuard blind(without, limits_);
  blind.add(sonar(sonar_raw(0.24)), now_);
  EXPECT_EQ(blind.limit(kFast, now_).forward_mps, kFast.forward_mps);
}

TEST_F(BaseGuardTest, ABumperRaisesTheAlarmOnce) {
  guard_.add(Bumpers{false});
  EXPECT_FALSE(guard_.take_alarm());
  guard_.add(Bumpers{true});
  EXPECT_EQ(guard_.take_alarm(), Alarm::kBumper);
  EXPECT_FALSE(guard_.take_alarm());
  guard_.add(Bumpers{true});  // still touched, after a person has released the robot
  EXPECT_FALSE(guard_.take_alarm());
  guard_.add(Bumpers{false});
  guard_.add(Bumpers{true});
  EXPECT_EQ(guard_.take_alarm(), Alarm::kBumper);
  GuardParams without = params_;
  without.use_bumper = false;
  BaseGuard deaf(without, limits_);
  deaf.add(Bumpers{true});
  EXPECT_FALSE(deaf.take_alarm());
  EXPECT_EQ(deaf.limit(kFast, now_).forward_mps, kFast.forward_mps);
}

TEST_F(BaseGuardTest, WhileTouchedOrTiltedItCreeps) {
  const auto expect_creeping = [this] {
    for (const double sign : {1.0, -1.0}) {
      const DriveCommand limited = guard_.limit({sign * 1.5, 0.5}, now_);
      EXPECT_DOUBLE_EQ(limited.forward_mps, sign * params_.creep_mps);
      EXPECT_DOUBLE_EQ(limited.yaw_rate_rad_s, 0.5 * params_.creep_mps / 1.5);
    }
    // A corner of the body, 0.3 m away, is no faster.
    EXPECT_DOUBLE_EQ(guard_.limit({0.0, -2.0}, now_).yaw_rate_rad_s, -params_.creep_mps / 0.3);
    EXPECT_EQ(guard_.limit({0.05, 0.2}, now_).yaw_rate_rad_s, 0.2);
  };
  guard_.add(Bumpers{true});
  expect_creeping();
  guard_.add(Bumpers{false});
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
  guard_.add(Tilt{0.0, 1.2}, now_);
  guard_.add(Tilt{0.0, 1.2}, now_ + 500ms);
  expect_creeping();
  guard_.add(Tilt{0.0, 0.1}, now_ + 600ms);
  EXPECT_EQ(guard_.limit(kFast, now_).forward_mps, kFast.forward_mps);
}

TEST_F(BaseGuardTest, ShakingDoesNotCountAsTilt) {
  guard_.add(Tilt{0.0, 1.2}, now_);
  guard_.add(Tilt{0.0, 0.1}, now_ + 300ms);
  for (const time::Duration t : {400ms, 600ms, 899ms}) {
    guard_.add(Tilt{-1.2, 0.0}, now_ + t);
    EXPECT_FALSE(guard_.take_alarm());
  }
  guard_.add(Tilt{-1.2, 0.0}, now_ + 900ms);
  EXPECT_EQ(guard_.take_alarm(), Alarm::kTilt);
  guard_.add(Tilt{-1.2, 0.0}, now_ + 2s);  // still tilted, after a person has released the robot
  EXPECT_FALSE(guard_.take_alarm());
}

TEST_F(BaseGuardTest, OnlyMoreThanThePermittedTiltCounts) {
  for (const double sign : {1.0, -1.0}) {
    for (const double beyond_rad : {-0.01, 0.01}) {
      const double tilt_rad = sign * (params_.max_tilt_rad + beyond_rad);
      for (const Tilt& tilt : {Tilt{tilt_rad, 0.0}, Tilt{0.0, tilt_rad}}) {
        BaseGuard guard(params_, limits_);
        guard.add(tilt, now_);
        guard.add(tilt, now_ + 500ms);
        EXPECT_EQ(guard.take_alarm().has_value(), beyond_rad > 0.0) << tilt_rad;
      }
    }
  }
}

// What the wheels do, every 10 ms.
struct Wheels {
  WheelSpeeds commanded;
  EncoderTicks even;  // in every second period
  EncoderTicks odd;   // in the others
};

TEST_F(BaseGuardTest, AWheelThatShouldTurnAndDoesNotIsStalled) {
  const auto is_stalled_after = [this](const Wheels& wheels, time::Duration duration) {
    BaseGuard guard(params_, limits_);
    for (time::Duration t{}; t <= duration; t += 10ms) {
      guard.add(t % 20ms == 0ms ? wheels.even : wheels.odd, wheels.commanded, now_ + t);
    }
    return guard.take_alarm().has_value();
  };
  const WheelSpeeds fast{0.5, 0.5};
  for (const Wheels& stalled :
       {Wheels{fast, {0, 0}, {0, 0}}, Wheels{fast, {0, 100}, {0, 100}},
        Wheels{fast, {100, 0}, {100, 0}}, Wheels{fast, {1, 1}, {-1, -1}},
        Wheels{{-0.5, 0.5}, {-100, 0}, {-100, 0}}, Wheels{{-0.5, -0.5}, {0, 0}, {0, 0}}}) {
    EXPECT_FALSE(is_stalled_after(stalled, 1990ms));
    EXPECT_TRUE(is_stalled_after(stalled, 2000ms));
  }
  for (const Wheels& turning :
       {Wheels{fast, {100, 100}, {100, 100}}, Wheels{fast, {0, 0}, {1, 1}},
        Wheels{{-0.5, -0.5}, {-100, -100}, {-100, -100}}, Wheels{{0.5, 0.0}, {100, 0}, {100, 0}},
        Wheels{{0.04, -0.04}, {0, 0}, {0, 0}}}) {
    EXPECT_FALSE(is_stalled_after(turning, 10s));
  }
}

TEST_F(BaseGuardTest, AStallIsTimedFromTheLastTurnOfTheWheel) {
  const WheelSpeeds fast{0.5, 0.5};
  time::SteadyTime t = now_;
  const auto add_for = [&](const EncoderTicks& ticks, const WheelSpeeds& commanded,
                           time::Duration duration) {
    for (const time::SteadyTime end = t + duration; t < end; t += 10ms) {
      guard_.add(ticks, commanded, t);
    }
  };
  add_for({100, 100}, fast, 3s);
  add_for({0, 0}, fast, 1990ms);  // the last turn was 10 ms before
  EXPECT_FALSE(guard_.take_alarm());
  // A command of zero speed ends what was timed before.
  add_for({0, 0}, {0.0, 0.0}, 5s);
  add_for({0, 0}, fast, 2s);
  EXPECT_FALSE(guard_.take_alarm());
  add_for({0, 0}, fast, 10ms);
  EXPECT_EQ(guard_.take_alarm(), Alarm::kStall);
}

}  // namespace base_guard_test
}  // namespace nodmap::kurt
