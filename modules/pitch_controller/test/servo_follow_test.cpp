// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/servo_follow.hpp"

#include <gtest/gtest.h>

namespace nodmap::pitch_controller {
namespace servo_follow_test {

constexpr double kAccelerationRadS2 = 40.0;

// One radian at 2 rad/s, and 0.05 s for a reversal.
SweepPlan plan() {
  SweepPlan plan;
  plan.sweep = {-0.6, 0.4};
  plan.nod = {plan.sweep, 2.0, 0.05};
  return plan;
}

// A sweep of the plan by a servo that is slower by this factor and stops short of its end.
MeasuredSweep sweep(double slower, double short_rad, bool is_upwards) {
  MeasuredSweep sweep;
  sweep.span = plan().sweep;
  (is_upwards ? sweep.span.max_rad : sweep.span.min_rad) -= is_upwards ? short_rad : -short_rad;
  sweep.peak_rate_rad_s = 2.0 / slower;
  sweep.duration_s =
      sweep.span.range_rad() / sweep.peak_rate_rad_s + sweep.peak_rate_rad_s / kAccelerationRadS2;
  sweep.is_complete = true;
  sweep.is_upwards = is_upwards;
  return sweep;
}

TEST(ServoFollow, AServoThatFollowsLeavesThePlanAsItIs) {
  ServoFollow dut(plan(), kAccelerationRadS2);
  dut.add(sweep(1.0, 0.0, true));
  dut.add(sweep(1.0, 0.0, false));
  const NodMotion nod = dut.motion(plan(), {});
  EXPECT_NEAR(nod.rate_rad_s, 2.0, 1e-12);
  EXPECT_EQ(nod.reversal_s, 0.05);
  EXPECT_EQ(dut.reached(plan()).min_rad, -0.6);
  EXPECT_EQ(dut.reached(plan()).max_rad, 0.4);
  EXPECT_NEAR(dut.peak_rate_rad_s(plan()), 2.0, 1e-12);
}

TEST(ServoFollow, TheSlowerOfTheLastTwoSweepsCounts) {
  ServoFollow dut(plan(), kAccelerationRadS2);
  dut.add(sweep(1.25, 0.0, true));
  EXPECT_NEAR(dut.motion(plan(), {}).rate_rad_s, 1.6, 1e-12);
  dut.add(sweep(1.0, 0.0, false));
  EXPECT_NEAR(dut.motion(plan(), {}).rate_rad_s, 1.6, 1e-12);
  dut.add(sweep(1.0, 0.0, true));
  EXPECT_NEAR(dut.motion(plan(), {}).rate_rad_s, 2.0, 1e-12);
}

TEST(ServoFollow, TheFasterOfTheLastTwoSweepsCountsForTheSpacing) {
  ServoFollow dut(plan(), kAccelerationRadS2);
  dut.add(sweep(0.8, 0.0, true));
  dut.add(sweep(1.0, 0.0, false));
  EXPECT_NEAR(dut.peak_rate_rad_s(plan()), 2.5, 1e-12);
  dut.add(sweep(1.0, 0.0, true));
  EXPECT_NEAR(dut.peak_rate_rad_s(plan()), 2.0, 1e-12);
}

// A servo that does better than planned may do so only once.
TEST(ServoFollow, NothingIsBetterThanThePlan) {
  ServoFollow dut(plan(), kAccelerationRadS2);
  for (const bool is_upwards : {true, false}) {
    dut.add(sweep(0.8, -0.1, is_upwards));
  }
  EXPECT_NEAR(dut.motion(plan(), {}).rate_rad_s, 2.0, 1e-12);
  EXPECT_EQ(dut.reached(plan()).min_rad, -0.6);
  EXPECT_EQ(dut.reached(plan()).max_rad, 0.4);
  for (const bool is_upwards : {true, false}) {
    dut.add(sweep(1.25, 0.0, is_upwards));
  }
  EXPECT_NEAR(dut.peak_rate_rad_s(plan()), 2.0, 1e-12);
}

// During a sweep the plan was slower for a while: only that sweep may have been as slow.
TEST(ServoFollow, ASweepIsComparedWithAllPlansDuringIt) {
  SweepPlan slow = plan();
  slow.nod.rate_rad_s = 1.0;
  ServoFollow dut(plan(), kAccelerationRadS2);
  dut.set_plan(slow);
  dut.set_plan(plan());
  dut.add(sweep(2.0, 0.0, true));
  EXPECT_NEAR(dut.motion(plan(), {}).rate_rad_s, 2.0, 1e-12);
  dut.add(sweep(2.0, 0.0, false));
  EXPECT_NEAR(dut.motion(plan(), {}).rate_rad_s, 1.0, 1e-12);
  // It was faster for a while.
  SweepPlan fast = plan();
  fast.nod.rate_rad_s = 4.0;
  ServoFollow other(plan(), kAccelerationRadS2);
  other.set_plan(fast);
  other.set_plan(plan());
  other.add(sweep(0.5, 0.0, true));
  EXPECT_NEAR(other.peak_rate_rad_s(plan()), 2.0, 1e-12);
  other.add(sweep(0.5, 0.0, false));
  EXPECT_NEAR(other.peak_rate_rad_s(plan()), 4.0, 1e-12);
}

// A plan that has changed in the meantime is followed as badly.
TEST(ServoFollow, IsRelativeToThePlan) {
  ServoFollow dut(plan(), kAccelerationRadS2);
  dut.add(sweep(1.25, 0.1, true));
  dut.add(sweep(0.8, 0.05, false));
  SweepPlan narrow = plan();
  narrow.sweep = {-0.3, 0.2};
  narrow.nod = {narrow.sweep, 1.0, 0.025};
  EXPECT_NEAR(dut.motion(narrow, {}).rate_rad_s, 0.8, 1e-12);
  EXPECT_NEAR(dut.peak_rate_rad_s(narrow), 1.25, 1e-12);
  EXPECT_NEAR(dut.reached(narrow).min_rad, -0.25, 1e-12);
  EXPECT_NEAR(dut.reached(narrow).max_rad, 0.1, 1e-12);
}

// A head that is beyond the new ends has that angle to turn as well; one that is late is slower.
TEST(ServoFollow, ThePresentSweepCounts) {
  const ServoFollow dut(plan(), kAccelerationRadS2);
  MeasuredSweep present;
  present.span = {-0.9, 0.1};
  present.duration_s = 0.3;
  EXPECT_EQ(dut.motion(plan(), present).ends.min_rad, -0.9);
  EXPECT_EQ(dut.motion(plan(), present).ends.max_rad, 0.4);
  present.span = {-0.1, 0.7};
  EXPECT_EQ(dut.motion(plan(), present).ends.min_rad, -0.6);
  EXPECT_EQ(dut.motion(plan(), present).ends.max_rad, 0.7);
  present.span = {-0.9, 0.1};
  EXPECT_NEAR(dut.motion(plan(), present).rate_rad_s, 2.0, 1e-12);
  present.duration_s = 1.35;  // 1.3 rad in 1.3 s, and the reversal
  EXPECT_NEAR(dut.motion(plan(), present).rate_rad_s, 1.0, 1e-12);
}

}  // namespace servo_follow_test
}  // namespace nodmap::pitch_controller
