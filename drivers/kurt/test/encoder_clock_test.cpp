// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/encoder_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace nodmap::kurt {
namespace {

TEST(EncoderClock, SteadyFramesAreStampedAsTheyCome) {
  EncoderClock clock;
  for (int i = 0; i < 1000; ++i) {
    const auto reading = clock.take(1'000'000 + i * kEncoderPeriodUs);
    EXPECT_EQ(reading.measured_us, 1'000'000 + i * kEncoderPeriodUs);
    EXPECT_EQ(reading.lost, 0);
    EXPECT_EQ(reading.gap_us, 0);
  }
}

// Delays as of a USB adapter that sends every 16 ms, and a base whose quartz is 100 ppm off.
TEST(EncoderClock, JitterIsRemovedAndIsNoLoss) {
  for (const double period_us : {10'001.0, 9'999.0}) {
    EncoderClock clock;
    std::mt19937 random(3);
    std::uniform_int_distribution<std::int64_t> delay_us(500, 16'500);
    std::int64_t last_us = 0;
    for (int i = 0; i < 20'000; ++i) {
      const auto true_us = static_cast<std::int64_t>(1e9 + period_us * i);
      // Bytes on a line do not overtake each other.
      const std::int64_t arrival_us = std::max(last_us, true_us + delay_us(random));
      const auto reading = clock.take(arrival_us);
      EXPECT_EQ(reading.lost, 0) << i;
      EXPECT_EQ(reading.gap_us, 0);
      if (i > 500) {
        // The least delay in 500 frames is some 0.03 ms above 0.5 ms; between two such the estimate
        // runs ahead by a thousandth, and 3 ms cover 300 periods of that.
        EXPECT_NEAR(static_cast<double>(reading.measured_us - true_us), 500.0, 3000.0) << i;
      }
      last_us = arrival_us;
    }
  }
}

TEST(EncoderClock, StampsGoUpWithEveryFrame) {
  EncoderClock clock;
  std::mt19937 random(8);
  std::int64_t last_us = -1;
  for (int i = 0; i < 5000; ++i) {
    const std::int64_t arrival_us =
        i * kEncoderPeriodUs + static_cast<std::int64_t>(random() % 80'000);
    const auto reading = clock.take(arrival_us);
    EXPECT_GT(reading.measured_us, last_us);
    last_us = reading.measured_us;
  }
}

TEST(EncoderClock, ALostFrameIsFoundWithinHalfASecond) {
  for (const int lost : {1, 2, 5}) {
    EncoderClock clock;
    std::mt19937 random(4);
    std::int64_t arrival_us = 0;
    int found = 0;
    int found_after = 0;
    for (int i = 0; i < 400; ++i) {
      const std::int64_t missing_us = i >= 220 ? lost * kEncoderPeriodUs : 0;
      arrival_us = i * kEncoderPeriodUs + missing_us + static_cast<std::int64_t>(random() % 3000);
      const auto reading = clock.take(arrival_us);
      if (reading.lost > 0) {
        found += reading.lost;
        found_after = i - 220;
      }
    }
    EXPECT_EQ(found, lost);
    // One whole window of 50 behind the one that it fell into.
    EXPECT_LE(found_after, 100);
    EXPECT_NEAR(static_cast<double>(clock.take(arrival_us + kEncoderPeriodUs).measured_us),
                static_cast<double>(arrival_us + kEncoderPeriodUs), 4000.0);
  }
}

// The process was held up for 60 ms; then everything comes at once. Nothing was lost.
TEST(EncoderClock, ADelayIsNoLoss) {
  EncoderClock clock;
  for (int i = 0; i < 1000; ++i) {
    const bool held_up = i % 100 >= 40 && i % 100 < 46;
    const std::int64_t arrival_us = (held_up ? i / 100 * 100 + 46 : i) * kEncoderPeriodUs;
    const auto reading = clock.take(arrival_us);
    EXPECT_EQ(reading.lost, 0);
    EXPECT_EQ(reading.gap_us, 0);
  }
}

TEST(EncoderClock, ALongSilenceIsAGap) {
  EncoderClock clock;
  clock.take(0);
  clock.take(10'000);
  EXPECT_EQ(clock.take(1'010'000).gap_us, 1'000'000);
  EXPECT_EQ(clock.take(1'020'000).gap_us, 0);
  clock.restart();
  EXPECT_EQ(clock.take(1'040'000).gap_us, 20'000);
}

}  // namespace
}  // namespace nodmap::kurt
