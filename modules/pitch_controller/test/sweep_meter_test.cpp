// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::pitch_controller {
namespace sweep_meter_test {

// Gives the readings of one sweep at a constant rate, one every 5 ms; the last one is after the
// reversal.
class Feeder {
 public:
  std::optional<MeasuredSweep> sweep(double from, double to, double seconds) {
    std::optional<MeasuredSweep> ended;
    const int readings = static_cast<int>(std::lround(seconds / 0.005));
    for (int i = 1; i <= readings; ++i) {
      stamp += 5ms;
      const double pitch = from + (to - from) * i / readings;
      number += i == readings ? 1 : 0;
      ended = dut.add({stamp, pitch, (to - from) / seconds, number, false});
    }
    return ended;
  }

  SweepMeter dut;
  time::Timestamp stamp{1s};
  std::int64_t number = 0;
};

TEST(SweepMeter, MeasuresTimeSpanAndRate) {
  Feeder feeder;
  feeder.sweep(-0.2, 0.1, 0.3);
  const auto sweep = feeder.sweep(0.1, -0.3, 0.5);
  ASSERT_TRUE(sweep);
  EXPECT_TRUE(sweep->is_complete);
  EXPECT_NEAR(sweep->duration_s, 0.5, 1e-9);
  EXPECT_NEAR(sweep->span.min_rad, -0.3, 1e-12);
  EXPECT_NEAR(sweep->span.max_rad, 0.1, 1e-12);
  // The reading at a reversal belongs to both sweeps: 0.3 rad in 0.3 s before, 0.4 rad in 0.5 s
  // after.
  EXPECT_NEAR(sweep->peak_rate_rad_s, 1.0, 1e-9);
}

TEST(SweepMeter, TheLastTwoSweepsAreBothComplete) {
  Feeder feeder;
  feeder.sweep(-0.2, 0.1, 0.3);  // its start was not measured, so it is not complete
  EXPECT_FALSE(feeder.dut.last_two_sweeps());
  feeder.sweep(0.1, -0.3, 0.5);
  EXPECT_FALSE(feeder.dut.last_two_sweeps());
  feeder.sweep(-0.3, 0.2, 0.4);
  const auto sweeps = feeder.dut.last_two_sweeps();
  ASSERT_TRUE(sweeps);
  EXPECT_NEAR(sweeps->duration_s, 0.5, 1e-9);
  EXPECT_NEAR(sweeps->span.min_rad, -0.3, 1e-12);
  EXPECT_NEAR(sweeps->span.max_rad, 0.2, 1e-12);
}

TEST(SweepMeter, APresentSweepThatTakesLongerThanTheLastCountsAtOnce) {
  Feeder feeder;
  for (int i = 0; i < 3; ++i) {
    feeder.sweep(-0.2, 0.2, 0.3);
  }
  feeder.stamp += 55ms;
  feeder.dut.add({feeder.stamp, 0.0, 9.0, feeder.number, false});
  for (int i = 0; i < 100; ++i) {
    feeder.stamp += 5ms;
    feeder.dut.add({feeder.stamp, 0.0, 0.0, feeder.number, false});
  }
  EXPECT_NEAR(feeder.dut.last_two_sweeps()->duration_s, 0.555, 1e-9);
  EXPECT_EQ(feeder.dut.last_two_sweeps()->peak_rate_rad_s, 9.0);
}

TEST(SweepMeter, ASweepWithAGapIsNotComplete) {
  Feeder feeder;
  feeder.sweep(-0.2, 0.2, 0.3);
  feeder.sweep(0.2, -0.2, 0.3);
  for (const time::Duration missing : {200ms, 60ms}) {  // and the 5 ms to the next reading
    feeder.sweep(-0.2, 0.2, 0.3);
    ASSERT_TRUE(feeder.sweep(0.2, -0.2, 0.3)->is_complete);
    feeder.stamp += missing;
    const auto sweep = feeder.sweep(-0.2, 0.2, 0.3);
    EXPECT_FALSE(sweep->is_complete);
    EXPECT_FALSE(feeder.dut.last_two_sweeps());
  }
  feeder.number += 3;  // reversals that were missed
  EXPECT_FALSE(feeder.sweep(0.2, -0.2, 0.3)->is_complete);
}

// Of a few readings, whose duration is not known to a reversal.
TEST(SweepMeter, TheMeanRateOfTheShortestSweepIsPositive) {
  MeasuredSweep sweep;
  sweep.span = {0.0, 0.01};
  sweep.duration_s = 0.005;
  sweep.peak_rate_rad_s = 2.0;
  EXPECT_GT(sweep.mean_rate_rad_s(40.0), 0.0);
}

// The clock was set a little.
TEST(SweepMeter, AReadingThatStepsBackALittleIsLeftOut) {
  Feeder feeder;
  for (int i = 0; i < 4; ++i) {
    feeder.sweep(-0.2, 0.2, 0.3);
  }
  feeder.dut.add({feeder.stamp - 6ms, 1.0, 0.0, feeder.number, false});
  ASSERT_TRUE(feeder.dut.last_two_sweeps());
  const auto sweep = feeder.sweep(-0.2, 0.2, 0.3);
  ASSERT_TRUE(sweep);
  EXPECT_TRUE(sweep->is_complete);
  EXPECT_EQ(sweep->span.max_rad, 0.2);
}

TEST(SweepMeter, AfterARestartOfTheDriverMeasuringStartsAgain) {
  Feeder feeder;
  for (int i = 0; i < 4; ++i) {
    feeder.sweep(-0.2, 0.2, 0.3);
  }
  ASSERT_TRUE(feeder.dut.last_two_sweeps());
  feeder.number = 0;
  feeder.sweep(-0.2, 0.2, 0.3);
  EXPECT_FALSE(feeder.dut.last_two_sweeps());
  feeder.sweep(-0.2, 0.2, 0.3);
  feeder.sweep(-0.2, 0.2, 0.3);
  ASSERT_TRUE(feeder.dut.last_two_sweeps());
  feeder.stamp = {};
  feeder.sweep(-0.2, 0.2, 0.3);
  EXPECT_FALSE(feeder.dut.last_two_sweeps());
}

}  // namespace sweep_meter_test
}  // namespace nodmap::pitch_controller
