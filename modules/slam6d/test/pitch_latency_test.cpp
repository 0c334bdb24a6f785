// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/pitch_latency.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::slam6d {
namespace pitch_latency_test {

constexpr double kLatencyS = 0.0015;
constexpr double kTiltSigmaRad = 0.0025;  // ground that is uneven by 0.14 degrees

// A head that nods at 2 rad/s over uneven ground.
double learned_s(PitchLatency latency, int num_sweeps) {
  std::mt19937 random(3);
  std::normal_distribution<double> tilt(0.0, kTiltSigmaRad);
  for (int i = 0; i < num_sweeps; ++i) {
    const double rate_change = i % 2 == 0 ? 4.0 : -4.0;
    const double left_s = kLatencyS - latency.seconds();
    latency.learn(rate_change, left_s * rate_change + tilt(random), kTiltSigmaRad * kTiltSigmaRad);
  }
  return latency.seconds();
}

// The error of n sweeps is tilt sigma / (4 rad/s sqrt(n)): 0.06 ms for 100 of them; three times it.
TEST(PitchLatency, IsLearnedFromSweepsUpAndDown) {
  EXPECT_NEAR(learned_s(PitchLatency({}), 100), kLatencyS, 0.0002);
}

TEST(PitchLatency, OneSweepOfAStationaryRobotIsEnough) {
  PitchLatency latency({});
  latency.learn(-4.0, -4.0 * kLatencyS, 1e-8);
  // A measurement of 0.025 ms leaves a 6400th of a prior of 2 ms.
  EXPECT_NEAR(latency.seconds(), kLatencyS, 1e-6);
}

TEST(PitchLatency, NothingIsLearnedWithoutAnyDoubt) {
  EXPECT_EQ(learned_s(PitchLatency({.sigma_s = 0.0}), 100), 0.0);
}

TEST(PitchLatency, ASillIsNoLatency) {
  PitchLatency latency({});
  latency.learn(4.0, 0.1, 1e-6);  // 6 degrees; 3 sigma are 1.4
  EXPECT_EQ(latency.seconds(), 0.0);
}

TEST(PitchLatency, AHeadWhosePitchRateStaysTellsNothing) {
  PitchLatency latency({});
  latency.learn(0.0, 0.001, 1e-6);
  EXPECT_EQ(latency.seconds(), 0.0);
}

}  // namespace pitch_latency_test
}  // namespace nodmap::slam6d
