// SPDX-License-Identifier: BSD-3-Clause
// How the node drives to a goal, and which poses it uses for that.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "common/node/messages.hpp"
#include "modules/navigator/node.hpp"
#include "modules/navigator/test/navigator_node.hpp"

namespace nodmap::navigator {
namespace node_goal_test {

using test::NavigatorNodeScans;
using test::NavigatorNodeTest;

constexpr bus::Sender kOther{0x7F000001, 40'001};

// A navigator with a geofence: a square of 8 m.
class NavigatorNodeGeofence : public NavigatorNodeTest {
 protected:
  NavigatorNodeGeofence() : NavigatorNodeTest(false, "POLYGON((-4 -4, 4 -4, 4 4, -4 4))") {}

  void give_pose(double x_m, std::int8_t state = nodmap::pose_t::TRACKING) {
    nodmap::pose_t pose{};
    pose.utime = now_us_;
    pose.state = state;
    pose.orientation[0] = pose.odom_orientation[0] = 1.0;
    pose.odom_position_m[0] = x_m;
    bus_.deliver("POSE_2D", pose);
  }

  void run_with_poses(double duration_s, double x_m = 0.0) {
    for (double t = 0.0; t < duration_s - 0.05; t += 0.1) {
      give_pose(x_m);
      run(0.1);
    }
  }
};

TEST_F(NavigatorNodeGeofence, DrivesOnlyWhileThePoseIsAtMostTwoSecondsOld) {
  run(2.0);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "There is a geofence, but no pose from 2D SLAM.");
  run_with_poses(2.0);
  EXPECT_TRUE(drives());
  run(1.9);
  EXPECT_TRUE(drives()) << "the last pose is not older than 2 s";
  run(0.2);
  EXPECT_TRUE(halts());
  run_with_poses(2.0);
  EXPECT_TRUE(drives());
  give_pose(0.0, nodmap::pose_t::LOST);
  tick();
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "There is a geofence, but no pose from 2D SLAM.");
}

TEST_F(NavigatorNodeGeofence, TheAgeOfAPoseCountsFromItsMeasurement) {
  run_with_poses(2.0);
  ASSERT_TRUE(drives());
  nodmap::pose_t delayed{};
  delayed.utime = now_us_ - 2'500'000;
  delayed.state = nodmap::pose_t::TRACKING;
  delayed.orientation[0] = delayed.odom_orientation[0] = 1.0;
  bus_.deliver("POSE_2D", delayed);
  tick();
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "There is a geofence, but no pose from 2D SLAM.");
}

TEST_F(NavigatorNodeGeofence, APoseOfFormerOdometryIsNotUsed) {
  run_with_poses(2.0);
  run(0.3, kOdometry);  // a process takes at least as long to start
  odometry_seq_ = 0;
  give_odometry(now_us_);
  give_odometry(now_us_ + 10'000);
  now_us_ -= 100'000;
  give_pose(0.0);  // was still under way
  now_us_ += 100'000;
  EXPECT_EQ(rejected("pose_of_former_odometry"), 1);
  run(0.5);
  EXPECT_EQ(navigation().reason, "There is a geofence, but no pose from 2D SLAM.");
  run_with_poses(2.0);
  EXPECT_TRUE(drives());
}

// Its map begins where the robot is, so the fence would be elsewhere on the floor.
TEST_F(NavigatorNodeGeofence, AfterARestartOf2DSlamItHaltsUntilReleased) {
  run_with_poses(2.0);
  ASSERT_TRUE(drives());
  send_as(kOther);
  give_pose(0.0);
  send_as({});
  run(0.1);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason,
            "2D SLAM has started anew: the geofence must be confirmed by a release.");
  bus_.deliver("STOP", nodmap::stop_t{});
  run(1.5);
  EXPECT_TRUE(drives());
}

// A release is sent four times within 0.6 s. Who gave it has not seen what happened since.
TEST_F(NavigatorNodeGeofence, ACopyOfAnEarlierReleaseDoesNotConfirmIt) {
  nodmap::stop_t release{};
  bus_.deliver("STOP", release);
  run_with_poses(2.0);
  send_as(kOther);
  give_pose(0.0);
  send_as({});
  bus_.deliver("STOP", release);
  run(0.1);
  EXPECT_TRUE(halts());
  release.utime = 1;
  bus_.deliver("STOP", release);
  run(1.5);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeGeofence, BrakesBeforeTheBoundaryAndHaltsOutside) {
  run_with_poses(2.0, 1.0);
  ASSERT_TRUE(drives());
  const double front_m = robot::Body{}.footprint().half_length_m;
  EXPECT_NEAR(navigation().clear_distance_m, 4.0 - 1.0 - front_m, 0.02) << "a point each 2 cm";
  run_with_poses(0.1, 4.1);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "The robot is outside the geofence.");
}

TEST_F(NavigatorNodeGeofence, DoesNotDriveToAGoalOutside) {
  nodmap::goal_t goal{};
  goal.is_active = 1;
  goal.position_m[0] = 5.0;
  goal.tolerance_m = 0.3;
  bus_.deliver("GOAL", goal);
  run_with_poses(2.0);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "The goal is outside the geofence.");
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").state, nodmap::path_t::NO_PATH);
}

TEST_F(NavigatorNodeTest, GoesToAGoalInTheCorrectedMap) {
  run(1.5);
  nodmap::goal_t goal{};
  goal.is_active = true;
  goal.tolerance_m = 0.2;
  goal.position_m[0] = 3.0;
  goal.position_m[1] = 1.0;
  bus_.deliver("GOAL", goal);
  // The map is 1 m to the left of odom: in odom the goal is straight ahead.
  const auto give_pose = [this] {
    bus_.deliver("POSE_2D",
                 node::write_corrected_pose(time::from_utime(now_us_), geometry::to_se3({0, 1, 0}),
                                            geometry::to_se3({0, 1, 0})));
  };
  give_pose();
  tick();
  EXPECT_NEAR(navigation().steering_angle_rad, 0.0, 1e-9);
  x_ = 2.9;
  odometry_seq_ = 0;  // the robot is set down there, odometry begins anew
  run(1.5);
  EXPECT_TRUE(halts()) << "where the goal is in the new frame is not known yet";
  give_pose();
  run(0.1);
  EXPECT_EQ(navigation().behaviour, nodmap::navigation_t::ARRIVED);
  EXPECT_EQ(drive().forward_mps, 0.0);
  goal.tolerance_m = 0.0;
  bus_.deliver("GOAL", goal);
  EXPECT_EQ(rejected("implausible_goal"), 1);
  goal.tolerance_m = 10.5;
  bus_.deliver("GOAL", goal);
  EXPECT_EQ(rejected("goal_tolerance_above_10_m"), 1);
  goal.is_active = false;
  bus_.deliver("GOAL", goal);
  run(1.5);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, AGoalIsVoidOnceItsFrameIsGone) {
  nodmap::goal_t goal{};
  goal.is_active = 1;
  goal.tolerance_m = 0.2;
  goal.position_m[0] = 100.0;
  const auto expect_to_wait_for_a_goal = [&] {
    run(1.0);
    EXPECT_TRUE(halts());
    EXPECT_EQ(navigation().reason,
              "The map in which the goal was given is gone: waits for a new goal.");
    bus_.deliver("GOAL", goal);
    run(1.0);
    EXPECT_TRUE(halts()) << "its sender only repeats it";
    ++goal.utime;
    bus_.deliver("GOAL", goal);
    run(2.0);
    EXPECT_TRUE(drives());
  };
  run(1.5);
  bus_.deliver("GOAL", goal);
  run(1.0);
  ASSERT_TRUE(drives());
  odometry_seq_ = 0;
  expect_to_wait_for_a_goal();  // there is no 2D SLAM, so map was odom
  const auto pose = node::write_corrected_pose(time::from_utime(now_us_), geometry::SE3::Identity(),
                                               geometry::SE3::Identity());
  bus_.deliver("POSE_2D", pose);
  run(1.0);
  ASSERT_TRUE(drives());
  bus_.deliver_from(kOther, "POSE_2D", pose);
  expect_to_wait_for_a_goal();  // 2D SLAM has been restarted
}

// The robot has arrived within 5 cm, and stays so up to 15 cm; a goal 14 cm ahead is another one.
TEST_F(NavigatorNodeTest, AnotherGoalNearbyIsDrivenToAfterArriving) {
  run(1.5);
  nodmap::goal_t goal{};
  goal.is_active = true;
  goal.tolerance_m = 0.05;
  goal.position_m[0] = x_ + 0.02;
  bus_.deliver("GOAL", goal);
  run(0.1);
  ASSERT_EQ(navigation().behaviour, nodmap::navigation_t::ARRIVED);
  x_ -= 0.1;
  run(0.1);
  EXPECT_EQ(navigation().behaviour, nodmap::navigation_t::ARRIVED);
  ++goal.goal_seq;
  goal.position_m[0] = x_ + 0.14;
  bus_.deliver("GOAL", goal);
  run(0.1);
  EXPECT_NE(navigation().behaviour, nodmap::navigation_t::ARRIVED);
}

TEST_F(NavigatorNodeTest, AGoalWithAHeadingNeedsTolerancesAndTheLocalMap) {
  run(1.5);
  nodmap::goal_t goal{};
  goal.is_active = 1;
  goal.tolerance_m = 0.02;
  goal.has_heading = 1;
  goal.heading_rad = std::numeric_limits<double>::quiet_NaN();
  goal.heading_tolerance_rad = geometry::deg_to_rad(1.0);
  bus_.deliver("GOAL", goal);
  EXPECT_EQ(rejected("implausible_goal"), 1);
  goal.heading_rad = 0.0;
  goal.heading_tolerance_rad = 0.0;
  bus_.deliver("GOAL", goal);
  EXPECT_EQ(rejected("implausible_goal"), 2);
  goal.heading_tolerance_rad = geometry::deg_to_rad(1.0);
  bus_.deliver("GOAL", goal);
  tick();
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason,
            "Docks only with planner.use_planner and local_map.use_local_map.");
}

// Without a goal the pose in the map does not matter.
TEST_F(NavigatorNodeTest, OnTheWayToAGoalADegradedPoseSlowsItAndALostOneHaltsIt) {
  const auto give_pose = [this](std::int8_t state, double variance_m2 = 0.0) {
    auto pose = node::write_corrected_pose(time::from_utime(now_us_), geometry::SE3::Identity(),
                                           geometry::SE3::Identity());
    pose.state = state;
    // Half a metre along a corridor that runs diagonally in map; no error across it.
    pose.covariance[0][0] = pose.covariance[0][1] = variance_m2;
    pose.covariance[1][0] = pose.covariance[1][1] = variance_m2;
    bus_.deliver("POSE_2D", pose);
    tick();
  };
  run(1.5);
  give_pose(nodmap::pose_t::LOST);
  EXPECT_TRUE(drives());
  nodmap::goal_t goal{};
  goal.is_active = true;
  goal.tolerance_m = 0.2;
  goal.position_m[0] = 100.0;
  bus_.deliver("GOAL", goal);
  tick();
  EXPECT_TRUE(halts());
  EXPECT_NE(navigation().reason.find("lost"), std::string::npos) << navigation().reason;
  give_pose(nodmap::pose_t::TRACKING);
  run(2.0);
  const double fast_mps = navigation().max_forward_mps;
  give_pose(nodmap::pose_t::DEGRADED);
  run(2.0);
  EXPECT_GT(drive().forward_mps, 0.0);
  EXPECT_LE(drive().forward_mps, 0.5 * DriveParams{}.max_forward_mps);
  EXPECT_LT(navigation().max_forward_mps, fast_mps) << "the covariance is not known";
  give_pose(nodmap::pose_t::DEGRADED, 0.125);
  run(1.0);
  EXPECT_EQ(navigation().max_forward_mps, fast_mps) << "the goal is farther than three sigmas";
  goal.position_m[0] = 1.69;
  bus_.deliver("GOAL", goal);
  tick();
  EXPECT_LT(navigation().max_forward_mps, fast_mps);
  goal.position_m[0] = 1.71;
  bus_.deliver("GOAL", goal);
  tick();
  EXPECT_EQ(navigation().max_forward_mps, fast_mps);
}

// A robot whose wheels turn while, by 2D SLAM, it stays in the origin of map.
class NavigatorNodeSlips : public NavigatorNodeScans {
 protected:
  void run_on_the_spot(double duration_s, double wheels_mps) {
    for (int i = 1; i <= std::lround(100.0 * duration_s); ++i) {
      x_ += 0.01 * wheels_mps;
      tick_with_scan();
      if (i % 25 == 0) {
        give_pose(nodmap::pose_t::TRACKING);
      }
    }
  }

  // `age`: for how long the wheels have rotated since the pose was measured.
  void give_pose(std::int8_t state, time::Duration age = {}, double wheels_mps = 0.0) {
    const double x_then = x_ - wheels_mps * time::seconds(age);
    auto pose =
        node::write_corrected_pose(time::from_utime(now_us_) - age, geometry::SE3::Identity(),
                                   geometry::to_se3({-x_then, 0.0, 0.0}));
    pose.state = state;
    bus_.deliver("POSE_2D", pose);
  }

  // Whether the local map has an obstacle at a place on the robot's axis, in base.
  [[nodiscard]] bool is_obstacle(double x_base_m) const {
    const auto map = bus_.last<nodmap::local_map_t>("LOCAL_MAP");
    const int column = static_cast<int>((x_ + x_base_m - map.origin_m[0]) / map.cell_size_m);
    const int row = static_cast<int>(-map.origin_m[1] / map.cell_size_m);
    return map.cells.at(static_cast<std::size_t>(row * map.width + column)) ==
           nodmap::local_map_t::OBSTACLE;
  }

  [[nodiscard]] std::int64_t num_slips() const { return node_.metrics().at("slips"); }
};

// It has backed into glass, and its wheels stand when 2D SLAM shows that.
TEST_F(NavigatorNodeSlips, TheContactIsWhereTheWheelsHaveDriven) {
  const double half_m = robot::Body{}.footprint().half_length_m;
  run_on_the_spot(1.0, 0.0);
  run_on_the_spot(0.74, -0.2);
  run_on_the_spot(0.01, 0.0);
  give_pose(nodmap::pose_t::TRACKING);
  ASSERT_EQ(num_slips(), 1);
  run_on_the_spot(0.5, 0.0);  // the local map is published twice a second
  EXPECT_TRUE(is_obstacle(-half_m - 0.025));
  EXPECT_FALSE(is_obstacle(half_m + 0.025));
}

// At 1 m/s the wheels count 8 cm until 2D SLAM has matched the scan.
TEST_F(NavigatorNodeSlips, TheContactIsWhereOdometryIsWhenAFastRobotNoticesIt) {
  const double half_m = robot::Body{}.footprint().half_length_m;
  run_on_the_spot(1.0, 0.0);
  run_on_the_spot(0.2, 1.0);
  give_pose(nodmap::pose_t::TRACKING);
  run_on_the_spot(0.2, 1.0);
  give_pose(nodmap::pose_t::TRACKING, 80ms, 1.0);
  ASSERT_EQ(num_slips(), 1);
  run_on_the_spot(0.5, 0.0);
  EXPECT_TRUE(is_obstacle(half_m + 0.025));
}

// It has driven half a metre ahead before it runs into glass.
TEST_F(NavigatorNodeSlips, BacksUpTheWayItCame) {
  run_on_the_spot(0.24, 0.0);
  for (int i = 0; i < 50; ++i) {
    x_ += 0.01;
    tick_with_scan();
  }
  run_on_the_spot(2.0, 0.0);
  run_on_the_spot(0.2, 1.0);
  give_pose(nodmap::pose_t::TRACKING);
  run_on_the_spot(0.2, 1.0);
  ASSERT_EQ(num_slips(), 0);
  give_pose(nodmap::pose_t::TRACKING);
  ASSERT_EQ(num_slips(), 1);
  run_on_the_spot(0.2, 0.0);
  EXPECT_EQ(drive().forward_mps, -BackUpParams{}.speed_mps) << navigation().reason;
  EXPECT_EQ(drive().yaw_rate_rad_s, 0.0);
  // The contact stays where it is while the robot backs up.
  run_on_the_spot(1.0, -0.1);
  EXPECT_TRUE(is_obstacle(robot::Body{}.footprint().half_length_m + 0.1 + 0.025));
}

// What is found again after it was lost is elsewhere: that does not compare.
TEST_F(NavigatorNodeSlips, APoseThatWasLostIsNotCompared) {
  run_on_the_spot(1.0, 0.0);
  for (int i = 0; i < 20; ++i) {
    run_on_the_spot(0.25, 0.4);
    give_pose(nodmap::pose_t::LOST);
  }
  EXPECT_EQ(num_slips(), 0);
}

}  // namespace node_goal_test
}  // namespace nodmap::navigator
