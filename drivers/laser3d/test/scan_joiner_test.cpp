// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/scan_joiner.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::laser3d {
namespace {

MirrorRevolution revolution_at(std::int64_t first_us) {
  MirrorRevolution revolution;
  revolution.first_beam_us = first_us;
  revolution.last_beam_us = first_us + 6660;
  revolution.ranges_m = {1.0F, 2.0F};
  return revolution;
}

TEST(ScanJoiner, R2_PitchAtBothEndsIsInterpolated) {
  ScanJoiner dut;
  dut.add(PitchSample{0, 0.0, 1.0});
  dut.add(PitchSample{10'000, 0.01, 1.0});
  dut.add(revolution_at(2000));
  const auto joined = dut.next(12'000);
  ASSERT_TRUE(joined);
  EXPECT_NEAR(joined->pitch_first_rad, 0.002, 1e-12);
  EXPECT_NEAR(joined->pitch_last_rad, 0.00866, 1e-12);
}

TEST(ScanJoiner, R2_ANoddingHeadIsFollowedToATenthOfAMilliradian) {
  // 40 degrees to and fro at 1 Hz, sampled every 5 ms: linear interpolation is off by at most
  // max|acceleration| dt^2 / 8 = 0.35 * (2 pi)^2 * 0.005^2 / 8 = 4.3e-5 rad.
  const auto pitch = [](std::int64_t t_us) {
    return 0.35 * std::sin(2e-6 * 3.14159265358979 * static_cast<double>(t_us));
  };
  ScanJoiner dut;
  int joined = 0;
  for (std::int64_t now_us = 0; now_us < 2'000'000; now_us += 1000) {
    if (now_us % 5000 == 0) {
      dut.add(PitchSample{now_us, pitch(now_us), 0.0});
    }
    if (now_us % 13'000 == 12'000) {
      dut.add(revolution_at(now_us - 8000));
    }
    while (const auto revolution = dut.next(now_us)) {
      ++joined;
      EXPECT_NEAR(revolution->pitch_first_rad, pitch(revolution->revolution.first_beam_us), 5e-5);
      EXPECT_NEAR(revolution->pitch_last_rad, pitch(revolution->revolution.last_beam_us), 5e-5);
    }
  }
  EXPECT_GT(joined, 150);
  EXPECT_EQ(dut.dropped(), 0);
}

TEST(ScanJoiner, ARevolutionWaitsForTheSampleAfterIt) {
  ScanJoiner dut;
  dut.add(PitchSample{0, 0.0, 0.0});
  dut.add(revolution_at(1000));
  EXPECT_FALSE(dut.next(8000));
  dut.add(PitchSample{10'000, 0.1, 0.0});
  EXPECT_TRUE(dut.next(10'500));
}

TEST(ScanJoiner, AfterItsPatienceItExtrapolatesALittle) {
  ScanJoiner dut;
  dut.add(PitchSample{0, 0.0, 2.0});
  dut.add(revolution_at(1000));
  EXPECT_FALSE(dut.next(37'000));
  const auto joined = dut.next(37'660);  // 30 ms after the last beam
  ASSERT_TRUE(joined);
  EXPECT_NEAR(joined->pitch_last_rad, 2.0 * 0.00766, 1e-12);
}

TEST(ScanJoiner, BeyondTheBoundItIsDropped) {
  ScanJoiner dut;
  dut.add(PitchSample{0, 0.0, 2.0});
  dut.add(revolution_at(4000));  // its last beam is 10.66 ms beyond the sample
  EXPECT_FALSE(dut.next(1'000'000));
  EXPECT_EQ(dut.dropped(), 1);
}

TEST(ScanJoiner, NothingBeforeTheFirstSampleAndNothingAcrossAGap) {
  ScanJoiner dut;
  dut.add(PitchSample{10'000, 0.0, 0.0});
  dut.add(PitchSample{20'000, 0.0, 0.0});
  dut.add(revolution_at(5000));
  EXPECT_FALSE(dut.next(20'000));
  dut.add(PitchSample{200'000, 1.0, 0.0});
  dut.add(revolution_at(100'000));
  EXPECT_FALSE(dut.next(200'000));
  EXPECT_EQ(dut.dropped(), 2);
}

TEST(ScanJoiner, WithoutAServoNothingComesOutAndNothingPilesUp) {
  ScanJoiner dut;
  for (int i = 0; i < 1000; ++i) {
    dut.add(revolution_at(i * 13'320));
    EXPECT_FALSE(dut.next(i * 13'320 + 7000));
  }
  EXPECT_GT(dut.dropped(), 980);
}

TEST(ScanJoiner, ForgottenPitchIsNotUsed) {
  ScanJoiner dut;
  dut.add(PitchSample{0, 0.0, 0.0});
  dut.add(PitchSample{10'000, 0.0, 0.0});
  dut.forget_pitch();
  EXPECT_FALSE(dut.pitch_at(5000));
}

TEST(ScanJoiner, SamplesThatStepBackAreDropped) {
  ScanJoiner dut;
  dut.add(PitchSample{10'000, 1.0, 0.0});
  dut.add(PitchSample{9'000, 5.0, 0.0});
  EXPECT_EQ(dut.pitch_at(10'000), 1.0);
  EXPECT_FALSE(dut.pitch_at(9'000));
}

}  // namespace
}  // namespace nodmap::laser3d
