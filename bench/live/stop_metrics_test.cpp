// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/stop_metrics.hpp"

#include <gtest/gtest.h>

namespace nodmap::bench {
namespace {

// 1.5 m/s until 1 s + 100 ms, then 3 m/s^2: stands 500 ms later.
std::vector<Motion> braking() {
  std::vector<Motion> motions;
  double x_m = 0.0;
  for (std::int64_t t_us = 0; t_us <= 2'000'000; t_us += 1000) {
    const double braked_s = 1e-6 * static_cast<double>(t_us - 1'100'000);
    const double v_mps = braked_s < 0.0 ? 1.5 : std::max(0.0, 1.5 - 3.0 * braked_s);
    motions.push_back({t_us, x_m, 1.0, v_mps, 0.0});
    x_m += 1e-3 * v_mps;
  }
  return motions;
}

TEST(StopMetrics, AreTimeAndDistanceBeyondBrakingAtOnce) {
  const auto stop = stop_metrics(braking(), 1'000'000);
  ASSERT_TRUE(stop);
  EXPECT_DOUBLE_EQ(stop->speed_mps, 1.5);
  // Below 2 cm/s is stationary: 7 ms early; a step of 1 ms.
  EXPECT_NEAR(stop->excess_time_s(3.0), 0.1, 0.009);
  EXPECT_NEAR(stop->excess_distance_m(3.0), 0.15, 0.002);
}

TEST(StopMetrics, ARobotThatRotatesOnTheSpotHasNotStopped) {
  std::vector<Motion> motions = braking();
  for (Motion& motion : motions) {
    motion.yaw_rate_rad_s = 0.5;
  }
  EXPECT_FALSE(stop_metrics(motions, 1'000'000));
}

TEST(StopMetrics, NeedTheEnd) {
  std::vector<Motion> motions = braking();
  motions.resize(1300);
  EXPECT_FALSE(stop_metrics(motions, 1'000'000));
  EXPECT_FALSE(stop_metrics(motions, 5'000'000));
  EXPECT_FALSE(stop_metrics({}, 0));
}

TEST(StopMetrics, OfAStationaryRobotAreZero) {
  const auto stop = stop_metrics(braking(), 1'900'000);
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->time_s, 0.0);
  EXPECT_EQ(stop->distance_m, 0.0);
}

}  // namespace
}  // namespace nodmap::bench
