// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/encoder_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace nodmap::kurt {
namespace encoder_clock_test {

constexpr time::SteadyTime kStart{1s};

TEST(EncoderClock, SteadyFramesAreStampedOnArrival) {
  EncoderClock clock;
  for (int i = 0; i < 1000; ++i) {
    const auto reading = clock.take(kStart + i * kEncoderPeriod);
    EXPECT_EQ(reading.measured, kStart + i * kEncoderPeriod);
    EXPECT_EQ(reading.lost, 0);
    EXPECT_EQ(reading.gap, 0us);
  }
}

// Delays as of a USB adapter that sends every 16 ms, and a base whose quartz is 100 ppm off.
TEST(EncoderClock, JitterIsRemovedAndIsNoLoss) {
  for (const time::FineDuration period : {10'001us, 9'999us}) {
    EncoderClock clock;
    std::mt19937 random(3);
    std::uniform_int_distribution<std::int64_t> delay(500, 16'500);
    time::SteadyTime last;
    for (int i = 0; i < 20'000; ++i) {
      const time::SteadyTime sent(std::chrono::duration_cast<time::Duration>(1000s + i * period));
      // Bytes on a line do not overtake each other.
      const time::SteadyTime arrival = std::max(last, sent + time::Duration(delay(random)));
      const auto reading = clock.take(arrival);
      EXPECT_EQ(reading.lost, 0) << i;
      EXPECT_EQ(reading.gap, 0us);
      if (i > 500) {
        // The least delay in 500 frames is some 0.03 ms above 0.5 ms; between two such the estimate
        // runs ahead by a thousandth, and 3 ms cover 300 periods of that.
        EXPECT_NEAR(time::seconds(reading.measured - sent), 0.0005, 0.003) << i;
      }
      last = arrival;
    }
  }
}

TEST(EncoderClock, StampsGoUpWithEveryFrame) {
  EncoderClock clock;
  std::mt19937 random(8);
  time::SteadyTime last{-1us};
  for (int i = 0; i < 5000; ++i) {
    const time::SteadyTime arrival =
        kStart + i * kEncoderPeriod + time::Duration(random() % 80'000);
    const auto reading = clock.take(arrival);
    EXPECT_GT(reading.measured, last);
    last = reading.measured;
  }
}

TEST(EncoderClock, ALostFrameIsFoundWithinHalfASecond) {
  for (const int lost : {1, 2, 5}) {
    EncoderClock clock;
    std::mt19937 random(4);
    time::SteadyTime arrival;
    int found = 0;
    int found_after = 0;
    for (int i = 0; i < 400; ++i) {
      const time::Duration missing = i >= 220 ? lost * kEncoderPeriod : 0us;
      arrival = kStart + i * kEncoderPeriod + missing + time::Duration(random() % 3000);
      const auto reading = clock.take(arrival);
      if (reading.lost > 0) {
        found += reading.lost;
        found_after = i - 220;
      }
    }
    EXPECT_EQ(found, lost);
    // One whole window of 50 behind the one that it fell into.
    EXPECT_LE(found_after, 100);
    EXPECT_LE(std::chrono::abs(clock.take(arrival + kEncoderPeriod).measured -
                               (arrival + kEncoderPeriod)),
              4ms);
  }
}

// A bad line. DRIVE carries these stamps, and one that is 200 ms old is not obeyed.
TEST(EncoderClock, ManyLostFramesAreFoundWhileStampsStayRecent) {
  constexpr int kPeriods = 6000;
  for (const double share : {0.05, 0.1, 0.2, 0.25}) {
    EncoderClock clock;
    std::mt19937 random(6);
    std::bernoulli_distribution is_lost(share);
    int lost = 0;
    int found = 0;
    for (int i = 0; i < kPeriods; ++i) {
      if (is_lost(random)) {
        ++lost;
        continue;
      }
      const time::SteadyTime arrival =
          kStart + i * kEncoderPeriod + time::Duration(random() % 3000);
      const auto reading = clock.take(arrival);
      found += reading.lost;
      EXPECT_EQ(reading.gap, 0us);
      EXPECT_LT(arrival - reading.measured, 200ms);
    }
    EXPECT_LE(found, lost);
    // The last 20 may not have been found yet. The estimate, which runs ahead by a thousandth,
    // swallows some others.
    EXPECT_GE(found, lost - 20 - kPeriods / 1000) << share;
  }
}

// The process was delayed for 60 ms; then all frames are read at once. Nothing was lost.
TEST(EncoderClock, ADelayIsNoLoss) {
  EncoderClock clock;
  for (int i = 0; i < 1000; ++i) {
    const bool held_up = i % 100 >= 40 && i % 100 < 46;
    const time::SteadyTime arrival = kStart + (held_up ? i / 100 * 100 + 46 : i) * kEncoderPeriod;
    const auto reading = clock.take(arrival);
    EXPECT_EQ(reading.lost, 0);
    EXPECT_EQ(reading.gap, 0us);
  }
}

TEST(EncoderClock, ALongSilenceIsAGap) {
  EncoderClock clock;
  clock.take(kStart);
  clock.take(kStart + 10ms);
  EXPECT_EQ(clock.take(kStart + 1010ms).gap, 1s);
  EXPECT_EQ(clock.take(kStart + 1020ms).gap, 0us);
  EXPECT_EQ(clock.take(kStart + 1120ms).gap, 0us);
  EXPECT_GT(clock.take(kStart + 1221ms).gap, 100ms);
}

// By more than half a period, for example because a slower adapter has been plugged in.
TEST(EncoderClock, ADelayThatLastsIsNoLoss) {
  EncoderClock clock;
  for (int i = 0; i < 1000; ++i) {
    const time::Duration delay = i < 220 ? 0ms : 6ms;
    EXPECT_EQ(clock.take(kStart + i * kEncoderPeriod + delay).lost, 0) << i;
  }
}

}  // namespace encoder_clock_test
}  // namespace nodmap::kurt
