// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/pitch_latency.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::slam6d {
namespace pitch_latency_test {

constexpr double kLatencyS = 0.0015;
constexpr double kTiltSigmaRad = 0.0025;  // ground that is uneven by 0.14 degrees

// Returns the latency that is learned from sweeps of a head that nods at 2 rad/s while the robot
// drives over uneven ground.
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

// The standard deviation after n sweeps is the sigma of the tilt / (4 rad/s sqrt(n)), which is 0.06
// ms for 100 sweeps. The tolerance is three times that.
TEST(PitchLatency, IsLearnedFromSweepsUpAndDown) {
  EXPECT_NEAR(learned_s(PitchLatency({}), 100), kLatencyS, 0.0002);
}

TEST(PitchLatency, OneSweepOfAStationaryRobotIsEnough) {
  PitchLatency latency({});
  latency.learn(-4.0, -4.0 * kLatencyS, 1e-8);
  // The measurement is exact to 0.025 ms and the prior to 2 ms, so that the prior has 1/6400 of the
  // weight.
  EXPECT_NEAR(latency.seconds(), kLatencyS, 1e-6);
}

TEST(PitchLatency, WithASigmaOfZeroNothingIsLearned) {
  EXPECT_EQ(learned_s(PitchLatency({.sigma_s = 0.0}), 100), 0.0);
}

TEST(PitchLatency, ADoorSillIsNotTakenForLatency) {
  PitchLatency latency({});
  latency.learn(4.0, 0.1, 1e-6);  // 6 degrees; 3 sigma are 1.4
  EXPECT_EQ(latency.seconds(), 0.0);
}

TEST(PitchLatency, NothingIsLearnedFromAConstantPitchRate) {
  PitchLatency latency({});
  latency.learn(0.0, 0.001, 1e-6);
  EXPECT_EQ(latency.seconds(), 0.0);
}

}  // namespace pitch_latency_test
}  // namespace nodmap::slam6d
