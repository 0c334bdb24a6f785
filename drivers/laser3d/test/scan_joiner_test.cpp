// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/scan_joiner.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::laser3d {
namespace scan_joiner_test {

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

MirrorRevolution revolution_at(time::SteadyTime first) {
  MirrorRevolution revolution;
  revolution.first_beam = first;
  revolution.last_beam = first + 6660us;
  revolution.ranges_m = {1.0F, 2.0F};
  return revolution;
}

TEST(ScanJoiner, R2_PitchAtBothEndsIsInterpolated) {
  ScanJoiner dut;
  dut.add(PitchSample{at(0us), 0.0, 1.0});
  dut.add(PitchSample{at(10ms), 0.01, 1.0});
  dut.add(revolution_at(at(2ms)));
  const auto joined = dut.next(at(12ms));
  ASSERT_TRUE(joined);
  EXPECT_NEAR(joined->pitch_first_rad, 0.002, 1e-12);
  EXPECT_NEAR(joined->pitch_last_rad, 0.00866, 1e-12);
}

TEST(ScanJoiner, R2_ANoddingHeadIsFollowedToATenthOfAMilliradian) {
  // 40 degrees to and fro at 1 Hz, sampled every 5 ms: linear interpolation is off by at most
  // max|acceleration| dt^2 / 8 = 0.35 * (2 pi)^2 * 0.005^2 / 8 = 4.3e-5 rad.
  const auto pitch = [](time::SteadyTime t) {
    return 0.35 * std::sin(2.0 * 3.14159265358979 * time::seconds(t.time_since_epoch()));
  };
  ScanJoiner dut;
  int joined = 0;
  for (time::SteadyTime now; now < at(2s); now += 1ms) {
    if (now.time_since_epoch() % 5ms == 0ms) {
      dut.add(PitchSample{now, pitch(now), 0.0});
    }
    if (now.time_since_epoch() % 13ms == 12ms) {
      dut.add(revolution_at(now - 8ms));
    }
    while (const auto revolution = dut.next(now)) {
      ++joined;
      EXPECT_NEAR(revolution->pitch_first_rad, pitch(revolution->revolution.first_beam), 5e-5);
      EXPECT_NEAR(revolution->pitch_last_rad, pitch(revolution->revolution.last_beam), 5e-5);
    }
  }
  EXPECT_GT(joined, 150);
  EXPECT_EQ(dut.dropped(), 0);
}

TEST(ScanJoiner, ARevolutionWaitsForTheSampleAfterIt) {
  ScanJoiner dut;
  dut.add(PitchSample{at(0us), 0.0, 0.0});
  dut.add(revolution_at(at(1ms)));
  EXPECT_FALSE(dut.next(at(8ms)));
  dut.add(PitchSample{at(10ms), 0.1, 0.0});
  EXPECT_TRUE(dut.next(at(10'500us)));
}

TEST(ScanJoiner, AfterItsPatienceItExtrapolatesALittle) {
  ScanJoiner dut;
  dut.add(PitchSample{at(0us), 0.0, 2.0});
  dut.add(revolution_at(at(1ms)));
  EXPECT_FALSE(dut.next(at(37ms)));
  const auto joined = dut.next(at(37'660us));  // 30 ms after the last beam
  ASSERT_TRUE(joined);
  EXPECT_NEAR(joined->pitch_last_rad, 2.0 * 0.00766, 1e-12);
}

TEST(ScanJoiner, BeyondTheBoundItIsDropped) {
  ScanJoiner dut;
  dut.add(PitchSample{at(0us), 0.0, 2.0});
  dut.add(revolution_at(at(4ms)));  // its last beam is 10.66 ms beyond the sample
  EXPECT_FALSE(dut.next(at(1s)));
  EXPECT_EQ(dut.dropped(), 1);
}

TEST(ScanJoiner, NothingBeforeTheFirstSampleAndNothingAcrossAGap) {
  ScanJoiner dut;
  dut.add(PitchSample{at(10ms), 0.0, 0.0});
  dut.add(PitchSample{at(20ms), 0.0, 0.0});
  dut.add(revolution_at(at(5ms)));
  EXPECT_FALSE(dut.next(at(20ms)));
  dut.add(PitchSample{at(200ms), 1.0, 0.0});
  dut.add(revolution_at(at(100ms)));
  EXPECT_FALSE(dut.next(at(200ms)));
  EXPECT_EQ(dut.dropped(), 2);
}

TEST(ScanJoiner, AGapOfSixtyMillisecondsIsBridgedAndALongerOneIsNot) {
  for (const time::Duration gap : {60ms, 61ms}) {
    ScanJoiner dut;
    dut.add(PitchSample{at(0ms), 0.0, 0.0});
    dut.add(PitchSample{at(gap), 0.0, 0.0});
    EXPECT_EQ(dut.pitch_at(at(30ms)).has_value(), gap == 60ms);
  }
}

TEST(ScanJoiner, WithoutAServoNothingComesOutAndNothingPilesUp) {
  ScanJoiner dut;
  for (int i = 0; i < 1000; ++i) {
    dut.add(revolution_at(at(i * 13'320us)));
    EXPECT_FALSE(dut.next(at(i * 13'320us + 7ms)));
  }
  EXPECT_GT(dut.dropped(), 980);
}

TEST(ScanJoiner, ForgottenPitchIsNotUsed) {
  ScanJoiner dut;
  dut.add(PitchSample{at(0us), 0.0, 0.0});
  dut.add(PitchSample{at(10ms), 0.0, 0.0});
  dut.forget_pitch();
  EXPECT_FALSE(dut.pitch_at(at(5ms)));
}

TEST(ScanJoiner, SamplesThatStepBackAreDropped) {
  ScanJoiner dut;
  dut.add(PitchSample{at(10ms), 1.0, 0.0});
  dut.add(PitchSample{at(9ms), 5.0, 0.0});
  dut.add(PitchSample{at(10ms), 5.0, 0.0});
  dut.add(PitchSample{at(20ms), 1.0, 0.0});
  EXPECT_EQ(dut.pitch_at(at(10ms)), 1.0);
  EXPECT_EQ(dut.pitch_at(at(15ms)), 1.0);
  EXPECT_FALSE(dut.pitch_at(at(9ms)));
}

}  // namespace scan_joiner_test
}  // namespace nodmap::laser3d
