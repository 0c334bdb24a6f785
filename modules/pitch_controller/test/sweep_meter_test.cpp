// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_meter.hpp"

#include <gtest/gtest.h>

namespace nodmap::pitch_controller {
namespace {

/// Gives the readings of one sweep of constant rate, one each 5 ms; the last of them has turned.
class Feeder {
 public:
  std::optional<MeasuredSweep> sweep(double from, double to, double seconds) {
    std::optional<MeasuredSweep> ended;
    const int readings = static_cast<int>(std::lround(seconds / 0.005));
    for (int i = 1; i <= readings; ++i) {
      time_us += 5000;
      const double pitch = from + (to - from) * i / readings;
      number += i == readings ? 1 : 0;
      ended = dut.add({time_us, pitch, (to - from) / seconds, number, false});
    }
    return ended;
  }

  SweepMeter dut;
  std::int64_t time_us = 1'000'000;
  std::int64_t number = 0;
};

TEST(SweepMeter, MeasuresTimeSpanAndRate) {
  Feeder feeder;
  feeder.sweep(-0.2, 0.1, 0.3);
  const auto sweep = feeder.sweep(0.1, -0.3, 0.5);
  ASSERT_TRUE(sweep);
  EXPECT_TRUE(sweep->is_whole);
  EXPECT_NEAR(sweep->duration_s, 0.5, 1e-9);
  EXPECT_NEAR(sweep->span.min_rad, -0.3, 1e-12);
  EXPECT_NEAR(sweep->span.max_rad, 0.1, 1e-12);
  // The reading at a turn belongs to both sweeps: 0.3 rad in 0.3 s before, 0.4 rad in 0.5 s after.
  EXPECT_NEAR(sweep->peak_rate_rad_s, 1.0, 1e-9);
}

TEST(SweepMeter, APeriodIsTwoWholeSweeps) {
  Feeder feeder;
  feeder.sweep(-0.2, 0.1, 0.3);  // began unseen: not whole
  EXPECT_FALSE(feeder.dut.period());
  feeder.sweep(0.1, -0.3, 0.5);
  EXPECT_FALSE(feeder.dut.period());
  feeder.sweep(-0.3, 0.2, 0.4);
  const auto period = feeder.dut.period();
  ASSERT_TRUE(period);
  EXPECT_NEAR(period->duration_s, 0.5, 1e-9);
  EXPECT_NEAR(period->span.min_rad, -0.3, 1e-12);
  EXPECT_NEAR(period->span.max_rad, 0.2, 1e-12);
}

TEST(SweepMeter, ASweepUnderWayThatTakesLongerCountsAtOnce) {
  Feeder feeder;
  for (int i = 0; i < 3; ++i) {
    feeder.sweep(-0.2, 0.2, 0.3);
  }
  feeder.time_us += 55'000;
  feeder.dut.add({feeder.time_us, 0.0, 9.0, feeder.number, false});
  for (int i = 0; i < 100; ++i) {
    feeder.time_us += 5000;
    feeder.dut.add({feeder.time_us, 0.0, 0.0, feeder.number, false});
  }
  EXPECT_NEAR(feeder.dut.period()->duration_s, 0.555, 1e-9);
  EXPECT_EQ(feeder.dut.period()->peak_rate_rad_s, 9.0);
}

TEST(SweepMeter, ASweepWithAGapIsNotWhole) {
  Feeder feeder;
  feeder.sweep(-0.2, 0.2, 0.3);
  feeder.sweep(0.2, -0.2, 0.3);
  feeder.time_us += 200'000;
  const auto sweep = feeder.sweep(-0.2, 0.2, 0.3);
  EXPECT_FALSE(sweep->is_whole);
  EXPECT_FALSE(feeder.dut.period());
  feeder.number += 3;  // turns that nobody saw
  EXPECT_FALSE(feeder.sweep(0.2, -0.2, 0.3)->is_whole);
}

TEST(SweepMeter, ADriverThatStartedAnewIsMeasuredAnew) {
  Feeder feeder;
  for (int i = 0; i < 4; ++i) {
    feeder.sweep(-0.2, 0.2, 0.3);
  }
  ASSERT_TRUE(feeder.dut.period());
  feeder.number = 0;
  feeder.sweep(-0.2, 0.2, 0.3);
  EXPECT_FALSE(feeder.dut.period());
  feeder.sweep(-0.2, 0.2, 0.3);
  feeder.sweep(-0.2, 0.2, 0.3);
  ASSERT_TRUE(feeder.dut.period());
  feeder.time_us = 0;
  feeder.sweep(-0.2, 0.2, 0.3);
  EXPECT_FALSE(feeder.dut.period());
}

}  // namespace
}  // namespace nodmap::pitch_controller
