// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/nod.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::laser3d {
namespace nod_test {

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

// A head that accelerates: a trapezoidal profile towards its goal, as the servo has.
class Head {
 public:
  double pitch_rad = 0.0;
  double rate_rad_s = 0.0;
  bool jammed = false;
  double acceleration_rad_s2 = kAcceleration;

  void step(const Nod::Aim& aim, double dt_s) {
    if (jammed) {
      rate_rad_s = 0.0;
      return;
    }
    const double left = aim.goal_rad - pitch_rad;
    const double allowed =
        std::min(aim.speed_rad_s, std::sqrt(2.0 * acceleration_rad_s2 * std::abs(left)));
    const double wanted = std::copysign(allowed, left);
    rate_rad_s +=
        std::clamp(wanted - rate_rad_s, -acceleration_rad_s2 * dt_s, acceleration_rad_s2 * dt_s);
    pitch_rad += rate_rad_s * dt_s;
  }

  static constexpr double kAcceleration = 40.0;
};

NodParams params() {
  NodParams params;
  params.fallback = {-0.7, 0.3, 0.8};
  return params;
}

robot::HeadLimits limits() {
  return {.pitch_min_rad = -1.0,
          .pitch_max_rad = 1.0,
          .pitch_rate_rad_s = 3.0,
          .pitch_acceleration_rad_s2 = Head::kAcceleration};
}

struct Movement {
  double lowest_rad = 10.0;
  double highest_rad = -10.0;
  double slow_ratio = 0.0;
  std::vector<double> sweeps_s;
};

Movement run(Nod& dut, Head& head, double seconds, time::SteadyTime& now) {
  Movement result;
  std::int64_t sweep = dut.sweep();
  time::SteadyTime sweep_start = now;
  int slow = 0;
  int steps = 0;
  Nod::Aim aim = dut.aim();
  const time::SteadyTime end = now + time::from_seconds(seconds);
  for (; now < end; now += 1ms) {
    head.step(aim, 1e-3);
    if (now.time_since_epoch() % 5ms != 0ms) {
      continue;
    }
    aim = dut.step({now, head.pitch_rad, head.rate_rad_s}, now);
    result.lowest_rad = std::min(result.lowest_rad, head.pitch_rad);
    result.highest_rad = std::max(result.highest_rad, head.pitch_rad);
    slow += std::abs(head.rate_rad_s) < 0.1 * aim.speed_rad_s ? 1 : 0;
    ++steps;
    if (dut.sweep() != sweep) {
      sweep = dut.sweep();
      result.sweeps_s.push_back(time::seconds(now - sweep_start));
      sweep_start = now;
    }
  }
  result.slow_ratio = static_cast<double>(slow) / steps;
  return result;
}

TEST(Nod, R7_NodsWithoutStoppingAtTheEnds) {
  Nod dut(params(), limits());
  Head head;
  time::SteadyTime now;
  run(dut, head, 1.0, now);
  const Movement result = run(dut, head, 20.0, now);
  EXPECT_LT(result.slow_ratio, 0.0104);  // 1.25 times what is measured
  EXPECT_FALSE(dut.is_stalled());
}

TEST(Nod, R9_ReachesBothEnds) {
  Nod dut(params(), limits());
  Head head;
  time::SteadyTime now;
  const Movement result = run(dut, head, 10.0, now);
  EXPECT_NEAR(result.lowest_rad, -0.7, 8.2e-4);  // 1.25 times what is measured; R3 demands 2.2e-3
  EXPECT_NEAR(result.highest_rad, 0.3, 8.2e-4);
}

TEST(Nod, R11_MeanSweepTimeIsWithinFivePercent) {
  for (const double sweep_s : {0.3, 0.8, 2.0}) {
    NodParams with = params();
    with.fallback = {-0.5, 0.2, sweep_s};
    Nod dut(with, limits());
    Head head;
    time::SteadyTime now;
    run(dut, head, 3.0, now);
    const std::int64_t before = dut.sweep();
    run(dut, head, 40.0, now);
    const double mean_s = 40.0 / static_cast<double>(dut.sweep() - before);
    EXPECT_NEAR(mean_s, sweep_s, 0.05 * sweep_s);
  }
}

TEST(Nod, R3_WhatTheMechanicsCannotDoIsCutOff) {
  Nod dut(params(), limits());
  time::SteadyTime now;
  EXPECT_TRUE(dut.command({-2.0, 2.0, 0.01}, now));
  const Nod::Aim aim = dut.step({now, 0.0, 0.0}, now);
  EXPECT_EQ(aim.goal_rad, 1.0);
  EXPECT_EQ(aim.speed_rad_s, 3.0);
  EXPECT_EQ(dut.step({now + 1s, 1.0, 0.0}, now).goal_rad, -1.0);
  // 5.5 rad/s would do for this one.
  EXPECT_TRUE(dut.command({-1.0, 1.0, 0.5}, now));
  EXPECT_EQ(dut.step({now + 1s, 0.0, 0.0}, now).speed_rad_s, 3.0);
}

TEST(Nod, WithoutCommandsItFallsBack) {
  Nod dut(params(), limits());
  EXPECT_TRUE(dut.command({0.1, 0.2, 1.0}, at(0s)));
  EXPECT_EQ(dut.step({at(500ms), 0.0, 0.0}, at(500ms)).goal_rad, 0.2);
  EXPECT_EQ(dut.step({at(1500ms), 0.15, 0.1}, at(1500ms)).goal_rad, 0.3);
}

TEST(Nod, InvalidCommandsAreRefused) {
  Nod dut(params(), limits());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(dut.command({nan, 0.0, 1.0}, at(0s)));
  EXPECT_FALSE(dut.command({-infinity, 0.0, 1.0}, at(0s)));
  EXPECT_FALSE(dut.command({0.0, infinity, 1.0}, at(0s)));
  EXPECT_FALSE(dut.command({0.5, -0.5, 1.0}, at(0s)));
  EXPECT_FALSE(dut.command({-0.5, 0.5, 0.0}, at(0s)));
  EXPECT_FALSE(dut.command({-0.5, 0.5, nan}, at(0s)));
  EXPECT_FALSE(dut.command({-0.5, 0.5, 1e300}, at(0s)));  // its square is infinite
}

TEST(Nod, EqualEndsHoldTheLaser) {
  NodParams with = params();
  with.fallback = {0.0, 0.0, 1.0};
  Nod dut(with, limits());
  Head head;
  head.pitch_rad = 0.4;
  time::SteadyTime now;
  run(dut, head, 2.0, now);
  // 1.25 times what is measured after 2 s.
  EXPECT_NEAR(head.pitch_rad, 0.0, 1.8e-5);
  EXPECT_EQ(dut.sweep(), 0);
  EXPECT_FALSE(dut.is_stalled());
}

TEST(Nod, AHeadThatDoesNotReachThePitchItIsToHoldIsStalled) {
  NodParams with = params();
  with.fallback = {0.0, 0.0, 1.0};
  Nod dut(with, limits());
  Head head;
  head.pitch_rad = 0.4;
  head.jammed = true;
  time::SteadyTime now;
  run(dut, head, 0.3, now);
  EXPECT_TRUE(dut.is_stalled());
}

// At 0.1 rad/s or more; the pitch controller commands no less than a third of a radian. A head with
// little acceleration takes long to reverse.
TEST(Nod, AHeadThatFollowsIsNeverStalled) {
  for (const double acceleration_rad_s2 : {Head::kAcceleration, 4.0}) {
    for (const double range_rad : {0.1, 0.7, 1.5}) {
      for (const double sweep_s : {0.35, 0.8, 10.0 * range_rad}) {
        NodParams with = params();
        with.fallback = {-0.6 * range_rad, 0.4 * range_rad, sweep_s};
        robot::HeadLimits slow = limits();
        slow.pitch_acceleration_rad_s2 = acceleration_rad_s2;
        Nod dut(with, slow);
        Head head;
        head.acceleration_rad_s2 = acceleration_rad_s2;
        time::SteadyTime now;
        while (now < at(10s)) {
          run(dut, head, 0.005, now);
          ASSERT_FALSE(dut.is_stalled())
              << range_rad << " rad, " << sweep_s << " s, " << acceleration_rad_s2;
        }
      }
    }
  }
}

// At any position, including the ends, where it takes longest: a reserve of 40 ms, the reversal of
// 60 ms at most, twice the time for a quarter of a degree, and two readings. In 115 ms the robot
// drives 16 cm at 1.4 m/s.
TEST(Nod, AJammedHeadIsNoticedInTimeWhereverItIs) {
  struct Case {
    double sweep_s;
    time::Duration within;
  };
  for (const Case& with : {Case{3.0, 115ms}, Case{1.3, 115ms}, Case{0.5, 115ms}}) {
    for (time::Duration jam_after = 3s; jam_after < 6s; jam_after += 10ms) {
      NodParams slow_or_fast = params();
      slow_or_fast.fallback.sweep_s = with.sweep_s;
      Nod dut(slow_or_fast, limits());
      Head head;
      time::SteadyTime now;
      run(dut, head, time::seconds(jam_after), now);
      ASSERT_FALSE(dut.is_stalled());
      head.jammed = true;
      run(dut, head, time::seconds(with.within), now);
      EXPECT_TRUE(dut.is_stalled())
          << with.sweep_s << " s a sweep, jammed at " << time::seconds(jam_after);
    }
  }
}

TEST(Nod, AJammedHeadTriesBothWaysAndComesBack) {
  Nod dut(params(), limits());
  Head head;
  time::SteadyTime now;
  run(dut, head, 2.2, now);
  ASSERT_FALSE(dut.is_stalled());
  const std::int64_t sweep = dut.sweep();
  head.jammed = true;
  run(dut, head, 0.3, now);
  EXPECT_TRUE(dut.is_stalled());
  int num_up = 0;
  for (int i = 0; i < 100; ++i) {
    run(dut, head, 0.05, now);
    num_up += dut.aim().goal_rad > head.pitch_rad ? 1 : 0;
  }
  // Each way half of the time.
  EXPECT_GT(num_up, 25);
  EXPECT_LT(num_up, 75);
  EXPECT_TRUE(dut.is_stalled());
  EXPECT_EQ(dut.sweep(), sweep) << "reversing in vain is no sweep";
  head.jammed = false;
  run(dut, head, 1.0, now);
  EXPECT_FALSE(dut.is_stalled());
  EXPECT_GE(run(dut, head, 5.0, now).sweeps_s.size(), 5U);
}

// At the head's highest rate its reversals would take longer than the whole of the shortest sweep.
TEST(Nod, ASweepShorterThanPossibleIsTheShortest) {
  Nod dut(params(), limits());
  constexpr double kRangeRad = 0.05;
  ASSERT_TRUE(dut.command({0.0, kRangeRad, 0.01}, {}));
  // Half of the way with constant acceleration, half with constant deceleration.
  const double shortest_s = 2.0 * std::sqrt(kRangeRad / Head::kAcceleration);
  EXPECT_NEAR(time::seconds(dut.nod_period({})), 2.0 * shortest_s, 1e-6) << "a microsecond";
}

TEST(Nod, AGapInTheReadingsIsNoStall) {
  Nod dut(params(), limits());
  Head head;
  time::SteadyTime now;
  run(dut, head, 2.2, now);
  static_cast<void>(dut.step({now, head.pitch_rad, 0.0}, now));
  now += 10s;  // the servo was disconnected and is back at the same position
  static_cast<void>(dut.step({now, head.pitch_rad, 0.0}, now));
  EXPECT_FALSE(dut.is_stalled());
}

TEST(Nod, AServoThatStopsShortOfItsGoalStillReverses) {
  Nod dut(params(), limits());
  time::SteadyTime now;
  double pitch_rad = 0.0;
  for (; now < at(10s); now += 5ms) {
    const Nod::Aim& aim = dut.aim();
    const double goal = std::clamp(aim.goal_rad, -0.68, 0.28);  // 1.1 degrees short
    const double step =
        std::clamp(goal - pitch_rad, -0.005 * aim.speed_rad_s, 0.005 * aim.speed_rad_s);
    pitch_rad += step;
    static_cast<void>(dut.step({now, pitch_rad, step / 0.005}, now));
  }
  EXPECT_GE(dut.sweep(), 12);  // 0.8 s each at most
  EXPECT_FALSE(dut.is_stalled());
}

}  // namespace nod_test
}  // namespace nodmap::laser3d
