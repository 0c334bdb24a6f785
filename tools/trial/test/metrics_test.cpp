// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace nodmap::trial {
namespace {

/// 1 m/s for a second, then braking at 2 m/s2, standing from 1.5 s on, and off again at 2.5 s.
TrialRecord braking_record() {
  TrialRecord record;
  record.started_us = 0;
  for (int i = 0; i <= 300; ++i) {
    const double t = 0.01 * i;
    const double brake_s = std::clamp(t - 1.0, 0.0, 0.5);
    TruthSample sample;
    sample.time_us = 10'000LL * i;
    sample.forward_mps = i < 250 ? 1.0 - 2.0 * brake_s : 0.5;
    sample.T_world_base.translation().x() =
        std::min(t, 1.0) + brake_s - brake_s * brake_s + 0.5 * std::max(0.0, t - 2.5);
    sample.clearance_m = 1.0;
    record.truth.push_back(sample);
  }
  return record;
}

TEST(TrialMetrics, QuantilesByNearestRank) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) {
    values.push_back(i);
  }
  const Quantiles q = quantiles(values);
  EXPECT_EQ(q.p50, 50.0);
  EXPECT_EQ(q.p99, 99.0);
  EXPECT_EQ(q.max, 100.0);
  EXPECT_EQ(quantiles({7.0}).p99, 7.0);
  EXPECT_EQ(quantiles({}).n, 0U);
}

TEST(TrialMetrics, DriveCountsFromTheFirstScan) {
  TrialRecord record = braking_record();
  record.started_us = 500'000;
  for (std::size_t i = 120; i < record.truth.size(); ++i) {
    record.truth[i].collisions = 1;
  }
  record.truth[10].clearance_m = 0.1;  // before the first scan
  record.truth[200].clearance_m = 0.3;
  const DriveMetrics drive = drive_metrics(record);
  EXPECT_NEAR(drive.duration_s, 2.5, 1e-9);
  EXPECT_NEAR(drive.distance_m, 1.0, 1e-9);  // 0.5 + 0.25 + 0.25
  EXPECT_NEAR(drive.mean_speed_mps, 0.4, 1e-9);
  EXPECT_EQ(drive.max_speed_mps, 1.0);
  EXPECT_EQ(drive.min_clearance_m, 0.3);
  EXPECT_EQ(drive.collisions, 1);
  EXPECT_NEAR(*drive.first_collision_s, 0.7, 1e-9);
  EXPECT_EQ(*drive.first_motion_s, 0.0);  // it drives already
}

TEST(TrialMetrics, WithoutAScanThereIsNoDrive) {
  TrialRecord record = braking_record();
  record.started_us.reset();
  EXPECT_EQ(drive_metrics(record).duration_s, 0.0);
}

// By hand: 0.1 s at 1 m/s, then 0.5 s and 0.25 m of brakes.
TEST(TrialMetrics, StopIsTimedFromTheDisturbance) {
  const StopMetrics stop = stop_metrics(braking_record(), {"test", 900'000, 2'000'000}, 2.0);
  EXPECT_EQ(stop.speed_mps, 1.0);
  EXPECT_NEAR(*stop.stopped_after_s, 0.6, 0.011);  // below 0.02 m/s one sample early
  EXPECT_NEAR(stop.distance_m, 0.35, 0.001);
  EXPECT_NEAR(stop.braking_distance_m, 0.25, 1e-9);
  EXPECT_NEAR(*stop.resumed_after_s, 0.5, 1e-9);
}

TEST(TrialMetrics, ARobotThatDrivesOnHasNotStopped) {
  EXPECT_FALSE(stop_metrics(braking_record(), {"test", 100'000, 800'000}, 2.0).stopped_after_s);
}

}  // namespace
}  // namespace nodmap::trial
