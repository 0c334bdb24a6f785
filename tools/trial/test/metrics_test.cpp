// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace nodmap::trial {
namespace metrics_test {

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

// 1 m/s for a second, then braking at 2 m/s2, stationary from 1.5 s on, and driving again at 2.5
// s.
TrialRecord braking_record() {
  TrialRecord record;
  record.started = at(0s);
  for (int i = 0; i <= 300; ++i) {
    const double t = 0.01 * i;
    const double brake_s = std::clamp(t - 1.0, 0.0, 0.5);
    TruthSample sample;
    sample.instant = at(i * 10ms);
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
  record.started = at(500ms);
  for (std::size_t i = 120; i < record.truth.size(); ++i) {
    record.truth[i].contacts.collisions = 1;
  }
  record.truth[10].clearance_m = 0.1;  // before the first scan
  record.truth[200].clearance_m = 0.3;
  const DriveMetrics drive = drive_metrics(record);
  EXPECT_NEAR(drive.duration_s, 2.5, 1e-9);
  EXPECT_NEAR(drive.distance_m, 1.0, 1e-9);  // 0.5 + 0.25 + 0.25
  EXPECT_NEAR(drive.mean_speed_mps, 0.4, 1e-9);
  EXPECT_EQ(drive.max_speed_mps, 1.0);
  EXPECT_EQ(drive.min_clearance_m, 0.3);
  EXPECT_EQ(drive.contacts.collisions, 1);
  EXPECT_NEAR(*drive.first_collision_s, 0.7, 1e-9);
  EXPECT_EQ(*drive.first_motion_s, 0.0);  // it drives already
}

TEST(TrialMetrics, ACollisionIsNoticedWhenSlipIsReportedBeforeTheNext) {
  TrialRecord record = braking_record();
  record.started = at(0ms);
  for (std::size_t i = 50; i < record.truth.size(); ++i) {
    record.truth[i].contacts.collisions = i < 100 ? 1 : i < 200 ? 2 : 3;
  }
  record.slips = {at(300ms), at(800ms), at(900ms), at(2100ms)};
  const auto noticed_s = drive_metrics(record).noticed_s;
  ASSERT_EQ(noticed_s.size(), 3U);
  EXPECT_NEAR(noticed_s[0].value(), 0.3, 1e-9);
  EXPECT_FALSE(noticed_s[1]);
  EXPECT_NEAR(noticed_s[2].value(), 0.1, 1e-9);
}

// 1 m along x in a second, as braking_record() begins, with a goal at its end.
TrialRecord arriving_record(sim::World& world) {
  TrialRecord record = braking_record();
  record.truth.resize(101);
  record.moved = at(100ms);
  record.arrivals = {at(1s)};
  world.goals = {{1.0, 0.0}};
  return record;
}

TEST(TrialMetrics, SplIsTheShortestPathOverTheDriven) {
  sim::World world;
  const TrialRecord record = arriving_record(world);
  const GoalMetrics goal = goal_metrics(record, world, {0.3}, 0.8);
  EXPECT_EQ(goal.reached, at(1s));
  EXPECT_NEAR(goal.path_m, 1.0, 1e-9);
  EXPECT_NEAR(*goal.time_s, 1.0, 1e-9);
  EXPECT_NEAR(*goal.after_motion_s, 0.9, 1e-9);
  EXPECT_NEAR(*goal.spl, 0.5, 1e-9);  // (0.8 - 0.3) / 1.0
  EXPECT_EQ(goal_metrics(record, world, {0.3}, 2.0).spl, 1.0);
  EXPECT_FALSE(goal_metrics(record, world, {0.3}, std::nullopt).spl);
  EXPECT_NEAR(goal.start_to_goal_m, 1.0, 1e-9);
  EXPECT_NEAR(goal.remaining_m, 0.0, 1e-9);
}

TEST(TrialMetrics, AHeadingIsComparedWhereTheGoalHasOne) {
  sim::World world;
  const TrialRecord record = arriving_record(world);
  EXPECT_FALSE(goal_metrics(record, world, {0.3}, 1.0).heading_error_rad);
  world.goal_heading_rad = -0.1;
  EXPECT_NEAR(*goal_metrics(record, world, {0.3}, 1.0).heading_error_rad, 0.1, 1e-12);
}

// The pose by which it reports may be half a degree wrong.
TEST(TrialMetrics, ARobotThatFacesElsewhereHasNotDocked) {
  sim::World world;
  const TrialRecord record = arriving_record(world);
  const GoalTolerance tolerance{0.02, geometry::deg_to_rad(1.0)};
  world.goal_heading_rad = geometry::deg_to_rad(1.4);
  EXPECT_TRUE(goal_metrics(record, world, tolerance, 1.0).reached);
  world.goal_heading_rad = geometry::deg_to_rad(-1.6);
  EXPECT_FALSE(goal_metrics(record, world, tolerance, 1.0).reached);
  world.goal_heading_rad.reset();
  EXPECT_TRUE(goal_metrics(record, world, tolerance, 1.0).reached);
}

TEST(TrialMetrics, ARobotThatReportsItsArrivalElsewhereHasNotArrived) {
  sim::World world;
  TrialRecord record = arriving_record(world);
  // It is at 1 m. The pose by which it reports may be 2 cm wrong.
  world.goals = {{1.31, 0.0}};
  EXPECT_TRUE(goal_metrics(record, world, {0.3}, 1.7).reached);
  world.goals = {{1.33, 0.0}};
  EXPECT_FALSE(goal_metrics(record, world, {0.3}, 1.7).reached);
  world.goals = {{1.7, 0.0}};
  EXPECT_EQ(goal_metrics(record, world, {0.3}, 1.7).spl, 0.0);
  EXPECT_FALSE(goal_metrics(record, world, {0.3}, 1.7).reached);
  // By the rules of a task its report does not count.
  world.task.arrival_radius_m = 1.0;
  record.reached = at(700ms);
  EXPECT_EQ(goal_metrics(record, world, {0.3}, 1.7).reached, at(700ms));
  EXPECT_NEAR(goal_metrics(record, world, {0.3}, 1.7).path_m, 0.7, 1e-9);
}

TEST(TrialMetrics, TimeCloseToAPerson) {
  TrialRecord record = braking_record();
  for (std::size_t i = 0; i < record.truth.size(); ++i) {
    record.truth[i].person_clearance_m = i >= 100 && i < 150 ? 0.44 : 0.46;
  }
  EXPECT_NEAR(drive_metrics(record).close_to_person_s, 0.5, 1e-9);
}

TEST(TrialMetrics, WithoutAScanThereIsNoDrive) {
  TrialRecord record = braking_record();
  record.started.reset();
  EXPECT_EQ(drive_metrics(record).duration_s, 0.0);
}

// By hand: 0.1 s at 1 m/s, then braking for 0.5 s and 0.25 m.
TEST(TrialMetrics, StopIsTimedFromTheDisturbance) {
  const StopMetrics stop = stop_metrics(braking_record(), {"test", at(900ms), at(2s)}, 2.0);
  EXPECT_EQ(stop.speed_mps, 1.0);
  EXPECT_NEAR(*stop.stopped_after_s, 0.6, 0.011);  // below 0.02 m/s one sample early
  EXPECT_NEAR(stop.distance_m, 0.35, 0.001);
  EXPECT_NEAR(stop.braking_distance_m, 0.25, 1e-9);
  EXPECT_NEAR(*stop.resumed_after_s, 0.5, 1e-9);
}

// By hand: at 2.5 s it drives at 0.5 m/s, half of what it drove before.
TEST(TrialMetrics, ARobotHasResumedAtHalfOfItsSpeedBefore) {
  TrialRecord record = braking_record();
  for (std::size_t i = 200; i < 250; ++i) {
    record.truth[i].forward_mps = 0.49;
    record.truth[i].yaw_rate_rad_s = 1.0;
  }
  const Disturbance disturbance{"test", at(900ms), at(2s)};
  EXPECT_NEAR(*stop_metrics(record, disturbance, 2.0).resumed_after_s, 0.5, 1e-9);
  record.truth.resize(250);
  EXPECT_FALSE(stop_metrics(record, disturbance, 2.0).resumed_after_s);
}

TEST(TrialMetrics, AStationaryRobotHasResumedWhenItMoves) {
  TrialRecord record = braking_record();
  const Disturbance disturbance{"test", at(1600ms), at(2s)};
  EXPECT_NEAR(*stop_metrics(record, disturbance, 2.0).resumed_after_s, 0.5, 1e-9);
  record.truth[220].yaw_rate_rad_s = 0.1;  // it rotates on the spot
  EXPECT_NEAR(*stop_metrics(record, disturbance, 2.0).resumed_after_s, 0.2, 1e-9);
}

TEST(TrialMetrics, ARobotThatDrivesOnHasNotStopped) {
  EXPECT_FALSE(stop_metrics(braking_record(), {"test", at(100ms), at(800ms)}, 2.0).stopped_after_s);
}

TEST(TrialMetrics, ARobotThatRotatesOnTheSpotHasNotStopped) {
  TrialRecord record = braking_record();
  for (std::size_t i = 100; i < 180; ++i) {
    record.truth[i].yaw_rate_rad_s = -0.1;
  }
  const Disturbance disturbance{"test", at(900ms), at(2s)};
  EXPECT_NEAR(*stop_metrics(record, disturbance, 2.0).stopped_after_s, 0.9, 1e-9);
}

}  // namespace metrics_test
}  // namespace nodmap::trial
