// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/nod.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::laser3d {
namespace {

/// A head that accelerates: a trapezoidal profile towards its goal, as the servo has.
class Head {
 public:
  double pitch_rad = 0.0;
  double rate_rad_s = 0.0;
  bool jammed = false;

  void step(const Nod::Aim& aim, double dt_s) {
    if (jammed) {
      rate_rad_s = 0.0;
      return;
    }
    const double left = aim.goal_rad - pitch_rad;
    const double allowed =
        std::min(aim.speed_rad_s, std::sqrt(2.0 * kAcceleration * std::abs(left)));
    const double wanted = std::copysign(allowed, left);
    rate_rad_s += std::clamp(wanted - rate_rad_s, -kAcceleration * dt_s, kAcceleration * dt_s);
    pitch_rad += rate_rad_s * dt_s;
  }

  static constexpr double kAcceleration = 40.0;
};

NodParams params() {
  NodParams params;
  params.fallback = {-0.7, 0.3, 0.8};
  return params;
}

robot::RobotParams robot() {
  robot::RobotParams robot;
  robot.head.pitch_min_rad = -1.0;
  robot.head.pitch_max_rad = 1.0;
  robot.head.pitch_rate_rad_s = 3.0;
  robot.head.pitch_acceleration_rad_s2 = Head::kAcceleration;
  return robot;
}

struct Movement {
  double lowest_rad = 10.0;
  double highest_rad = -10.0;
  double slow_ratio = 0.0;
  std::vector<double> sweeps_s;
};

Movement run(Nod& dut, Head& head, double seconds, std::int64_t& now_us) {
  Movement result;
  std::int64_t sweep = dut.sweep();
  std::int64_t sweep_start_us = now_us;
  int slow = 0;
  int steps = 0;
  Nod::Aim aim = dut.aim();
  const std::int64_t end_us = now_us + std::llround(1e6 * seconds);
  for (; now_us < end_us; now_us += 1000) {
    head.step(aim, 1e-3);
    if (now_us % 5000 != 0) {
      continue;
    }
    aim = dut.step({now_us, head.pitch_rad, head.rate_rad_s}, now_us);
    result.lowest_rad = std::min(result.lowest_rad, head.pitch_rad);
    result.highest_rad = std::max(result.highest_rad, head.pitch_rad);
    slow += std::abs(head.rate_rad_s) < 0.1 * aim.speed_rad_s ? 1 : 0;
    ++steps;
    if (dut.sweep() != sweep) {
      sweep = dut.sweep();
      result.sweeps_s.push_back(1e-6 * static_cast<double>(now_us - sweep_start_us));
      sweep_start_us = now_us;
    }
  }
  result.slow_ratio = static_cast<double>(slow) / steps;
  return result;
}

TEST(Nod, R7_NodsWithoutStoppingAtTheEnds) {
  Nod dut(params(), robot());
  Head head;
  std::int64_t now_us = 0;
  run(dut, head, 1.0, now_us);
  const Movement result = run(dut, head, 20.0, now_us);
  EXPECT_LT(result.slow_ratio, 0.1);
  EXPECT_FALSE(dut.stalled());
}

TEST(Nod, R9_ReachesBothEnds) {
  Nod dut(params(), robot());
  Head head;
  std::int64_t now_us = 0;
  const Movement result = run(dut, head, 10.0, now_us);
  EXPECT_NEAR(result.lowest_rad, -0.7, 0.0025);  // 0.125 degrees, R3
  EXPECT_NEAR(result.highest_rad, 0.3, 0.0025);
}

TEST(Nod, R11_MeanSweepTimeIsWithinFivePercent) {
  for (const double sweep_s : {0.3, 0.8, 2.0}) {
    NodParams with = params();
    with.fallback = {-0.5, 0.2, sweep_s};
    Nod dut(with, robot());
    Head head;
    std::int64_t now_us = 0;
    run(dut, head, 3.0, now_us);
    const std::int64_t before = dut.sweep();
    run(dut, head, 40.0, now_us);
    const double mean_s = 40.0 / static_cast<double>(dut.sweep() - before);
    EXPECT_NEAR(mean_s, sweep_s, 0.05 * sweep_s);
  }
}

TEST(Nod, R3_WhatTheMechanicsCannotDoIsCutOff) {
  Nod dut(params(), robot());
  Head head;
  std::int64_t now_us = 0;
  EXPECT_TRUE(dut.command({-2.0, 2.0, 0.01}, now_us));
  const Nod::Aim aim = dut.step({0, 0.0, 0.0}, 0);
  EXPECT_EQ(aim.goal_rad, 1.0);
  EXPECT_EQ(aim.speed_rad_s, 3.0);
}

TEST(Nod, WithoutCommandsItFallsBack) {
  Nod dut(params(), robot());
  EXPECT_TRUE(dut.command({0.1, 0.2, 1.0}, 0));
  EXPECT_EQ(dut.step({500'000, 0.0, 0.0}, 500'000).goal_rad, 0.2);
  EXPECT_EQ(dut.step({1'500'000, 0.15, 0.1}, 1'500'000).goal_rad, 0.3);
}

TEST(Nod, CommandsThatAreNoneAreRefused) {
  Nod dut(params(), robot());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(dut.command({nan, 0.0, 1.0}, 0));
  EXPECT_FALSE(dut.command({0.5, -0.5, 1.0}, 0));
  EXPECT_FALSE(dut.command({-0.5, 0.5, 0.0}, 0));
  EXPECT_FALSE(dut.command({-0.5, 0.5, nan}, 0));
}

TEST(Nod, EqualEndsHoldTheLaser) {
  NodParams with = params();
  with.fallback = {0.0, 0.0, 1.0};
  Nod dut(with, robot());
  Head head;
  head.pitch_rad = 0.4;
  std::int64_t now_us = 0;
  run(dut, head, 2.0, now_us);
  EXPECT_NEAR(head.pitch_rad, 0.0, 1e-3);
  EXPECT_EQ(dut.sweep(), 0);
  EXPECT_FALSE(dut.stalled());
}

// Whenever it jams, at the ends, too. 130 ms is what the navigator has for it; the slow and the
// very fast sweep have longer by the formula, and the robot drives with neither.
TEST(Nod, AJammedHeadIsNoticedInTimeWhereverItIs) {
  struct Case {
    double sweep_s;
    std::int64_t within_us;
  };
  for (const Case& with : {Case{3.0, 140'000}, Case{1.3, 130'000}, Case{0.5, 250'000}}) {
    for (std::int64_t jam_us = 3'000'000; jam_us < 6'000'000; jam_us += 50'000) {
      NodParams slow_or_fast = params();
      slow_or_fast.fallback.sweep_s = with.sweep_s;
      Nod dut(slow_or_fast, robot());
      Head head;
      std::int64_t now_us = 0;
      run(dut, head, 1e-6 * static_cast<double>(jam_us), now_us);
      ASSERT_FALSE(dut.stalled());
      head.jammed = true;
      run(dut, head, 1e-6 * static_cast<double>(with.within_us), now_us);
      EXPECT_TRUE(dut.stalled()) << with.sweep_s << " s a sweep, jammed at " << jam_us;
    }
  }
}

TEST(Nod, AJammedHeadTriesBothWaysAndComesBack) {
  Nod dut(params(), robot());
  Head head;
  std::int64_t now_us = 0;
  run(dut, head, 2.2, now_us);
  ASSERT_FALSE(dut.stalled());
  head.jammed = true;
  run(dut, head, 0.3, now_us);
  EXPECT_TRUE(dut.stalled());
  const std::int64_t sweep = dut.sweep();
  run(dut, head, 5.0, now_us);
  EXPECT_TRUE(dut.stalled());
  EXPECT_EQ(dut.sweep(), sweep) << "reversing in vain is no sweep";
  head.jammed = false;
  run(dut, head, 1.0, now_us);
  EXPECT_FALSE(dut.stalled());
  EXPECT_GE(run(dut, head, 5.0, now_us).sweeps_s.size(), 5U);
}

TEST(Nod, AGapInTheReadingsIsNoStall) {
  Nod dut(params(), robot());
  Head head;
  std::int64_t now_us = 0;
  run(dut, head, 2.2, now_us);
  now_us += 10'000'000;  // the servo was gone and is back where it was
  static_cast<void>(dut.step({now_us, head.pitch_rad, 0.0}, now_us));
  EXPECT_FALSE(dut.stalled());
}

TEST(Nod, AServoThatStopsShortOfItsGoalStillTurns) {
  Nod dut(params(), robot());
  std::int64_t now_us = 0;
  double pitch_rad = 0.0;
  for (; now_us < 10'000'000; now_us += 5000) {
    const Nod::Aim& aim = dut.aim();
    const double goal = std::clamp(aim.goal_rad, -0.68, 0.28);  // 1.1 degrees short
    const double step =
        std::clamp(goal - pitch_rad, -0.005 * aim.speed_rad_s, 0.005 * aim.speed_rad_s);
    pitch_rad += step;
    static_cast<void>(dut.step({now_us, pitch_rad, step / 0.005}, now_us));
  }
  EXPECT_GT(dut.sweep(), 9);
  EXPECT_FALSE(dut.stalled());
}

}  // namespace
}  // namespace nodmap::laser3d
