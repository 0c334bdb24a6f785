// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/stop_metrics.hpp"

#include <gtest/gtest.h>

namespace nodmap::bench {
namespace stop_metrics_test {

time::Timestamp at(time::Duration since_epoch) {
  return time::Timestamp(since_epoch);
}

// The robot drives at 1.5 m/s until 1.1 s, then brakes at 3 m/s^2 and is stationary 500 ms later.
std::vector<Motion> braking() {
  std::vector<Motion> motions;
  double x_m = 0.0;
  for (time::Timestamp t{}; t <= at(2s); t += 1ms) {
    const double braked_s = time::seconds(t - at(1100ms));
    const double v_mps = braked_s < 0.0 ? 1.5 : std::max(0.0, 1.5 - 3.0 * braked_s);
    motions.push_back({t, x_m, 1.0, v_mps, 0.0});
    x_m += 1e-3 * v_mps;
  }
  return motions;
}

TEST(StopMetrics, AreTimeAndDistanceBeyondImmediateBraking) {
  const auto stop = stop_metrics(braking(), at(1s));
  ASSERT_TRUE(stop);
  EXPECT_DOUBLE_EQ(stop->speed_mps, 1.5);
  // The robot counts as stationary below 2 cm/s, which is 7 ms early; motions come every 1 ms.
  EXPECT_NEAR(stop->excess_time_s(3.0), 0.1, 0.009);
  EXPECT_NEAR(stop->excess_distance_m(3.0), 0.15, 0.002);
}

TEST(StopMetrics, ARobotThatRotatesOnTheSpotHasNotStopped) {
  std::vector<Motion> motions = braking();
  for (Motion& motion : motions) {
    motion.yaw_rate_rad_s = 0.5;
  }
  EXPECT_FALSE(stop_metrics(motions, at(1s)));
}

TEST(StopMetrics, DoNotExistBeforeTheRobotIsStationary) {
  std::vector<Motion> motions = braking();
  motions.resize(1300);
  EXPECT_FALSE(stop_metrics(motions, at(1s)));
  EXPECT_FALSE(stop_metrics(motions, at(5s)));
  EXPECT_FALSE(stop_metrics({}, at(0s)));
}

TEST(StopMetrics, OfAStationaryRobotAreZero) {
  const auto stop = stop_metrics(braking(), at(1900ms));
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->time_s, 0.0);
  EXPECT_EQ(stop->distance_m, 0.0);
}

}  // namespace stop_metrics_test
}  // namespace nodmap::bench
