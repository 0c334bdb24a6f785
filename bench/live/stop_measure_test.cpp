// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/stop_measure.hpp"

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

TEST(MeasureStop, IsTimeAndWayBeyondBrakingAtOnce) {
  const auto stop = measure_stop(braking(), 1'000'000);
  ASSERT_TRUE(stop);
  EXPECT_DOUBLE_EQ(stop->speed_mps, 1.5);
  // Below 2 cm/s counts as standing: 7 ms early; a step of 1 ms.
  EXPECT_NEAR(stop->excess_time_s(3.0), 0.1, 0.009);
  EXPECT_NEAR(stop->excess_way_m(3.0), 0.15, 0.002);
}

TEST(MeasureStop, OfARobotThatTurnsOnTheSpotIsNotOver) {
  std::vector<Motion> motions = braking();
  for (Motion& motion : motions) {
    motion.yaw_rate_rad_s = 0.5;
  }
  EXPECT_FALSE(measure_stop(motions, 1'000'000));
}

TEST(MeasureStop, NeedsToSeeTheEnd) {
  std::vector<Motion> motions = braking();
  motions.resize(1300);
  EXPECT_FALSE(measure_stop(motions, 1'000'000));
  EXPECT_FALSE(measure_stop(motions, 5'000'000));
  EXPECT_FALSE(measure_stop({}, 0));
}

TEST(MeasureStop, OfARobotThatStandsIsNothing) {
  const auto stop = measure_stop(braking(), 1'900'000);
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->time_s, 0.0);
  EXPECT_EQ(stop->way_m, 0.0);
}

}  // namespace
}  // namespace nodmap::bench
