// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/results.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <optional>
#include <utility>

#include "modules/slam6d/test/hall.hpp"
#include "tests/support/logged.hpp"

namespace nodmap::slam6d {
namespace results_test {

using geometry::SE3;

// Adds a sweep that is taken at T_world_base of `room`.
void see(Slam6d& slam, const Room& room, const SE3& T_world_base, const SE3& T_odom_base) {
  const auto seed = static_cast<unsigned>(slam.num_sweeps());
  SweepCloud cloud = cloud_at(room, T_world_base, seed);
  cloud.stamp = time::Timestamp(seed * 1s);
  cloud.T_odom_base = T_odom_base;
  cloud.scans_used = 80;
  (void)slam.add_odometry(cloud.stamp, T_odom_base);
  (void)slam.add_cloud(std::move(cloud));
}

// The first sweep is the map, and in none of the counts.
TEST(Results, ThatMostSweepsWereLostIsAWarning) {
  Metrics metrics;
  metrics.sweeps_tracked = 4;
  metrics.sweeps_degraded = 1;
  metrics.sweeps_lost = 2;
  metrics.sweeps_unused = 4;
  EXPECT_EQ(nodmap::test::logged([&] { log_sweeps(metrics, 12); }),
            "info: sweeps: 4 tracked, 1 degraded, 2 lost, 4 not registered of 12\n");
  metrics.sweeps_lost = 3;
  metrics.sweeps_tracked = 3;
  EXPECT_EQ(nodmap::test::logged([&] { log_sweeps(metrics, 12); }),
            "warning: sweeps: 3 tracked, 1 degraded, 3 lost, 4 not registered of 12\n");
}

// Odometry is exact, and restarts at zero half way along the hall.
TEST(DrivenPath, GoesOnWhenOdometryRestarts) {
  Slam6d slam({});
  SE3 T_hall_odom = SE3::Identity();
  const auto poses = along_hall();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    see(slam, Room::hall(), poses[i], T_hall_odom.inverse() * poses[i]);
    if (i == poses.size() / 2) {
      EXPECT_TRUE(slam.change_odometry_frame(SE3::Identity()).empty());
      T_hall_odom = poses[i];
    }
  }
  const DrivenPath path = driven_path(slam);
  ASSERT_EQ(path.odometry.size(), poses.size());
  ASSERT_EQ(path.corrected.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    // The sum of the steps is exact but for rounding, from where the first sweep is placed.
    EXPECT_LT((path.odometry[i] - poses[i].translation()).norm(), 1e-9) << i;
    EXPECT_LT((path.corrected[i] - poses[i].translation()).norm(), 0.01) << i;
  }
}

// A robot in a saved map first sees another hall. Until it is found, its poses mean nothing.
TEST(DrivenPath, BeginsWhereTheRobotIsFoundInASavedMap) {
  Slam6d first({});
  for (const SE3& T_map_base : along_hall()) {
    see(first, Room::hall(), T_map_base, T_map_base);
  }
  Slam6d slam({});
  slam.restore(first.save(), std::nullopt, true);
  const SE3 T_map_start = pose(-2.2, 0.0, 0.0);  // odometry begins at zero here
  see(slam, slanting_hall(), SE3::Identity(), SE3::Identity());
  EXPECT_TRUE(driven_path(slam).corrected.empty());
  for (const double x_m : {0.2, 0.4, 0.6}) {
    see(slam, Room::hall(), T_map_start * pose(x_m, 0.0, 0.0), pose(x_m, 0.0, 0.0));
  }
  const DrivenPath path = driven_path(slam);
  ASSERT_EQ(path.corrected.size(), 3U);
  ASSERT_EQ(path.odometry.size(), 3U);
  for (std::size_t i = 0; i < path.corrected.size(); ++i) {
    const SE3 T_map_base = T_map_start * pose(0.2 * static_cast<double>(i + 1), 0.0, 0.0);
    // The tolerance is that of registration: 5 mm of range noise.
    EXPECT_LT((path.corrected[i] - T_map_base.translation()).norm(), 0.01) << i;
    EXPECT_LT((path.odometry[i] - T_map_base.translation()).norm(), 0.01) << i;
  }
}

}  // namespace results_test
}  // namespace nodmap::slam6d
