// SPDX-License-Identifier: BSD-3-Clause
// How the node acts on inputs that are lost, late or from another time.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <map>

#include "common/node/messages.hpp"
#include "modules/navigator/node.hpp"
#include "modules/navigator/test/navigator_node.hpp"

namespace nodmap::navigator {
namespace node_staleness_test {

using test::NavigatorNodeScans;
using test::NavigatorNodeTest;

TEST_F(NavigatorNodeTest, EachLostInputHaltsTheRobotUntilItIsBack) {
  // The limit and one period of odometry. Missing odometry is noticed when the next map comes.
  const std::map<int, double> limit_s{
      {kOdometry, 0.1}, {kMap, 0.1}, {kCommand, 0.12}, {kState, 0.15}};
  for (const auto& [lost, seconds] : limit_s) {
    run(2.0);
    ASSERT_TRUE(drives()) << lost;
    run(seconds, lost);
    EXPECT_FALSE(halts()) << lost;
    tick(lost);
    EXPECT_TRUE(halts()) << lost;
    EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
    run(2.0);
    EXPECT_TRUE(drives()) << lost;
  }
}

// 0.13 s without a map: the robot stops until the next map, then drives at half of the bound of 1
// m/s for two sweeps of 0.35 s.
TEST_F(NavigatorNodeTest, AfterAShortGapInTheScansItDrivesOnSlowly) {
  run(2.0);
  ASSERT_EQ(drive().forward_mps, 1.0);
  run(0.13, kMap);
  EXPECT_TRUE(halts());
  double slowly_s = 0.0;
  for (tick(); drive().forward_mps < 1.0 && slowly_s < 2.0; tick()) {
    ASSERT_EQ(drive().forward_mps, 0.5);
    slowly_s += 0.01;
  }
  EXPECT_GT(slowly_s, 0.35);  // one sweep and the rest of another
  EXPECT_LE(slowly_s, 0.7);
}

// The driver does not nod over so little: the laser looks everywhere with the next scan.
TEST_F(NavigatorNodeTest, WithAHeldLaserItDrivesOnAtOnceAfterAShortGap) {
  pitch_max_rad_ = -0.4 + geometry::deg_to_rad(0.4);
  run(2.0);
  ASSERT_EQ(drive().forward_mps, 1.0);
  run(0.13, kMap);
  EXPECT_TRUE(halts());
  tick();
  EXPECT_EQ(drive().forward_mps, 1.0);
}

// A gap of 0.13 s every half second: the same place may be missed each time, so the robot stops and
// looks.
TEST_F(NavigatorNodeTest, RepeatedGapsInTheScansMakeItStopAndLook) {
  run(2.0);
  ASSERT_TRUE(drives());
  run(0.13, kMap);
  run(0.37);
  run(0.13, kMap);
  tick();
  EXPECT_EQ(drive().forward_mps, 0.0);
}

TEST_F(NavigatorNodeTest, AfterALongGapInTheScansItStopsAndLooks) {
  run(2.0);
  ASSERT_TRUE(drives());
  run(0.25, kMap);
  run(0.35);
  EXPECT_EQ(drive().forward_mps, 0.0);
}

TEST_F(NavigatorNodeScans, LostScansHaltTheRobotUntilTheyAreBack) {
  run(0.5);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "There is no scan for the local map.");
  tick_with_scan();
  tick_with_scan();
  EXPECT_FALSE(halts());
  run(0.1);
  EXPECT_FALSE(halts());
  tick();
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "The scan for the local map is stale.");
  tick_with_scan();
  tick_with_scan();
  EXPECT_FALSE(halts());
}

TEST_F(NavigatorNodeTest, WithoutAnyMapItHaltsWithTheReason) {
  give_odometry(now_us_);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "There is no obstacle map.");
}

TEST_F(NavigatorNodeTest, MapsFromTheFutureOrThePastHaltOnlyUntilTheNextGoodOne) {
  run(1.5);
  bus_.deliver("OBSTACLE_MAP", empty_map(now_us_ + 3'600'000'000));
  EXPECT_TRUE(halts());
  tick();
  EXPECT_FALSE(halts());
  bus_.deliver("OBSTACLE_MAP", empty_map(now_us_ - 1'000'000));
  EXPECT_TRUE(halts());
  run(1.5);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, DrivesOnAfterAllClocksHaveSteppedBackTogether) {
  run(1.5);
  now_us_ -= 60'000'000;
  tick();
  EXPECT_TRUE(halts() || drive().forward_mps == 0.0);
  run(2.0);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, AfterOdometryHasRestartedItWaitsForANewMap) {
  run(1.5);
  run(0.3, kOdometry);  // a process takes at least as long to start
  odometry_seq_ = 0;
  x_ = 100.0;
  give_odometry(now_us_);
  give_odometry(now_us_ + 10'000);
  EXPECT_TRUE(halts());
  bus_.deliver("OBSTACLE_MAP", empty_map(now_us_ - 10'000));  // made in the former frame
  EXPECT_EQ(rejected("map_of_former_odometry"), 1);
  run(1.5);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, DrivesOnAfterTheBaseDriverHasRestartedAndThenTheClockIsSetBack) {
  run(1.5);
  odometry_seq_ = 0;
  tick();
  now_us_ -= 600'000'000;
  run(2.0);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, AMapTooFarFromOdometryHaltsIt) {
  run(1.5);
  auto map = empty_map(now_us_);
  map.position_m[0] = 50.0;
  bus_.deliver("OBSTACLE_MAP", map);
  give_odometry(now_us_ + 10'000);
  EXPECT_TRUE(halts());
}

// A navigator with a geofence, in which it drives only while it knows where it is.
class NavigatorNodeFence : public NavigatorNodeTest {
 protected:
  NavigatorNodeFence() : NavigatorNodeTest(false, "POLYGON((-4 -4, 4 -4, 4 4, -4 4))") {}

  void give_pose(std::int64_t utime_us) {
    bus_.deliver("POSE_2D",
                 node::write_corrected_pose(time::from_utime(utime_us), geometry::SE3::Identity(),
                                            geometry::SE3::Identity()));
  }

  // Delivers a pose every 0.1 s, which is this much ahead.
  void run_with_poses(double duration_s, time::Duration ahead = {}) {
    for (double t = 0.0; t < duration_s - 0.05; t += 0.1) {
      give_pose(now_us_ + time::to_us(ahead));
      run(0.1);
    }
  }
};

TEST_F(NavigatorNodeFence, APoseFromTheFutureCountsAsNone) {
  run_with_poses(2.0, 100ms);
  ASSERT_TRUE(drives());
  run_with_poses(2.2, 101ms);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "There is a geofence, but no pose from 2D SLAM.");
  EXPECT_EQ(rejected("pose_from_future"), 22);
  run_with_poses(2.0);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeFence, AnOldPoseOrAnImplausibleStampCountsAsNone) {
  run_with_poses(6.0);
  give_pose(now_us_ - 5'000'000);
  EXPECT_EQ(rejected("stale_pose"), 0);
  give_pose(now_us_ - 5'000'001);
  EXPECT_EQ(rejected("stale_pose"), 1);
  give_pose(-1);
  give_pose(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(rejected("implausible_pose"), 2);
}

}  // namespace node_staleness_test
}  // namespace nodmap::navigator
