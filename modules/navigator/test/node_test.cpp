// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/node.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "common/node/messages.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/people/test/walking_scene.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::navigator {
namespace node_test {

enum Input { kOdometry, kMap, kCommand, kState };

class NavigatorNodeTest : public ::testing::Test {
 protected:
  /// By the obstacle map alone, which these tests give; see NavigatorNodeScans.
  explicit NavigatorNodeTest(bool use_local_map = false, const char* geofence = "")
      : node_{context_, params(use_local_map, geofence)} {}

  static NavigatorParams params(bool use_local_map, const char* geofence) {
    NavigatorParams params;
    params.local_map.use = use_local_map;
    params.geofence = geofence;
    return params;
  }

  void give_odometry(std::int64_t utime_us) {
    auto message = node::write_odometry(time::from_utime(utime_us), geometry::to_se3({x_, 0, 0}));
    message.odometry_seq = odometry_seq_++;
    bus_.deliver("ODOMETRY", message);
  }

  static nodmap::egomap_t empty_map(std::int64_t utime_us) {
    nodmap::egomap_t map{};
    map.utime = utime_us;
    map.bin_first_rad = -geometry::kPi;
    map.bin_step_rad = geometry::deg_to_rad(1);
    map.orientation[0] = 1.0;
    map.num_bins = 360;
    map.distance_m.assign(360, std::numeric_limits<float>::infinity());
    const std::vector<float> none(360, std::numeric_limits<float>::quiet_NaN());
    map.point_x_m = map.point_y_m = map.point_z_m = map.age_s = none;
    return map;
  }

  void give_command(std::int64_t utime_us, double max_forward_mps = 1.0) {
    nodmap::pitch_command_t message{};
    message.utime = utime_us;
    message.command_seq = command_seq_++;
    message.pitch_min_rad = -0.4;
    message.pitch_max_rad = 0.1;
    message.sweep_s = 0.3;
    message.max_forward_mps = max_forward_mps;
    bus_.deliver("PITCH_COMMAND", message);
  }

  void give_state(std::int64_t utime_us, bool stalled = false) {
    nodmap::pitch_state_t message{};
    message.utime = utime_us;
    message.state_seq = state_seq_++;
    message.sweep_count = utime_us / 350'000;
    message.is_stalled = stalled;
    bus_.deliver("PITCH_STATE", message);
  }

  /// Delivers ten milliseconds of all inputs but the lost one.
  void tick(int lost = -1) {
    now_us_ += 10'000;
    if (lost != kCommand) {
      give_command(now_us_);
    }
    if (lost != kState) {
      give_state(now_us_);
    }
    if (lost != kOdometry) {
      give_odometry(now_us_);
    }
    if (lost != kMap) {
      auto map = empty_map(now_us_);
      map.position_m[0] = x_;
      bus_.deliver("OBSTACLE_MAP", map);
    }
  }

  void run(double duration_s, int lost = -1) {
    for (double t = 0.0; t < duration_s - 0.005; t += 0.01) {
      tick(lost);
    }
  }

  [[nodiscard]] nodmap::drive_t drive() const { return bus_.last<nodmap::drive_t>("DRIVE"); }
  [[nodiscard]] nodmap::navigation_t navigation() const {
    return bus_.last<nodmap::navigation_t>("NAVIGATION");
  }
  [[nodiscard]] bool halts() const {
    return navigation().behaviour == nodmap::navigation_t::HALT && drive().forward_mps == 0.0 &&
           drive().yaw_rate_rad_s == 0.0 && !navigation().reason.empty();
  }
  [[nodiscard]] bool drives() const { return drive().forward_mps > 0.5; }

  std::int64_t rejected(const std::string& cause) {
    const auto found = counts_.rejected().find(cause);
    return found == counts_.rejected().end() ? 0 : found->second;
  }

  nodmap::test::MemoryBus bus_;
  node::MessageCounts counts_;
  node::Context context_{bus_, counts_, {}};
  NavigatorNode node_;
  std::int64_t now_us_ = 1'000'000'000;
  std::int64_t odometry_seq_ = 0;
  std::int64_t command_seq_ = 0;
  std::int64_t state_seq_ = 0;
  double x_ = 0.0;
};

TEST_F(NavigatorNodeTest, OneDecisionForEachMapWhenAllInputsAreFresh) {
  run(1.5);
  ASSERT_TRUE(drives());
  const auto count = bus_.count("DRIVE");
  tick();
  EXPECT_EQ(bus_.count("DRIVE"), count + 1);
  EXPECT_EQ(drive().utime, now_us_);
  EXPECT_EQ(drive().valid_us, 150'000);
  EXPECT_EQ(navigation().drive_seq, drive().drive_seq);
  EXPECT_EQ(navigation().behaviour, nodmap::navigation_t::STEER);
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
  EXPECT_NEAR(navigation().corridor_width_m, 0.45, 1e-9);
}

TEST_F(NavigatorNodeTest, EachLostInputHaltsTheRobotUntilItIsBack) {
  // The limit and one odometry period; lost odometry is noticed with the maps.
  const std::map<int, double> limit_s{
      {kOdometry, 0.1}, {kMap, 0.1}, {kCommand, 0.15}, {kState, 0.15}};
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

// 0.13 s without a map: it stops for what is left of them and drives on, for two sweeps of 0.35 s
// at half of the bound of 1 m/s.
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
  EXPECT_GT(slowly_s, 0.35);  // one sweep and what is left of another
  EXPECT_LE(slowly_s, 0.7);
}

// 0.13 s each half second: each place may be missed again and again, so it stands and looks.
TEST_F(NavigatorNodeTest, GapsThatFollowOneAnotherMakeItStandAndLook) {
  run(2.0);
  ASSERT_TRUE(drives());
  run(0.13, kMap);
  run(0.37);
  run(0.13, kMap);
  tick();
  EXPECT_EQ(drive().forward_mps, 0.0);
}

TEST_F(NavigatorNodeTest, AfterALongGapInTheScansItStandsAndLooks) {
  run(2.0);
  ASSERT_TRUE(drives());
  run(0.25, kMap);
  run(0.35);
  EXPECT_EQ(drive().forward_mps, 0.0);
}

/// Drives by the local map, too.
class NavigatorNodeScans : public NavigatorNodeTest {
 protected:
  NavigatorNodeScans() : NavigatorNodeTest(true) {}

  /// A scan of flat ground whose middle is at the next tick, then that tick.
  void tick_with_scan() { tick_with(test::scan_of({}, {}, geometry::deg_to_rad(-20.0))); }

  void tick_with(scan::Scan scan) {
    scan.stamp = time::from_utime(now_us_) + 10ms - scan.duration / 2;
    scan.seq = scan_seq_++;
    tick();
    bus_.deliver("SCAN", node::write_scan(scan));
  }

  std::int64_t scan_seq_ = 0;
};

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

TEST_F(NavigatorNodeScans, ThePathToAGoalIsPublishedUntilThereIsNone) {
  nodmap::goal_t goal{};
  goal.is_active = true;
  goal.tolerance_m = 0.2;
  goal.position_m[0] = 3.0;
  bus_.deliver("GOAL", goal);
  for (int i = 0; i < 150; ++i) {  // it plans once the laser has looked: two sweeps of 0.35 s
    tick_with_scan();
  }
  const auto path = bus_.last<nodmap::path_t>("PATH");
  EXPECT_EQ(path.state, nodmap::path_t::PLANNED);
  ASSERT_GT(path.num_points, 10);
  // From the robot on; to the nearest of the cells that are the goal, 0.7 tolerances around it.
  EXPECT_NEAR(path.x_m.front(), 0.0, 0.1);
  EXPECT_NEAR(path.x_m.back(), 3.0, 0.2);
  EXPECT_NEAR(path.y_m.back(), 0.0, 0.2);
  ASSERT_EQ(path.num_arc_points, 9);
  EXPECT_EQ(path.arc_x_m.front(), 0.0);
  goal.is_active = false;
  bus_.deliver("GOAL", goal);
  tick_with_scan();
  tick();
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").state, nodmap::path_t::NO_GOAL);
}

// Somebody crosses 2.2 m ahead, out of the room. His track lies on him, to the tolerances of
// PeopleTracker's own test, and a message without anybody ends it.
TEST_F(NavigatorNodeScans, TracksArePublishedUntilThereIsNobody) {
  std::int64_t num_on_him = 0;
  test::WalkingScene scene{{{}}, 8.0};
  for (double time_s = 0.0; time_s < 15.0; time_s += 0.01) {
    scene.pillars[0].center = {2.2, time_s - 4.0};
    tick_with(scene.scan({}, {}, test::nodding_pitch_rad(time_s)));
    const bool is_in_view = time_s > 3.3 && time_s < 5.0;
    const auto tracks = is_in_view ? bus_.last<nodmap::tracks_t>("TRACKS") : nodmap::tracks_t{};
    if (tracks.num_tracks == 1 && tracks.state[0] == nodmap::tracks_t::WALKS) {
      ++num_on_him;
      EXPECT_NEAR(tracks.position_m[0][0], 2.2, 0.25);
      EXPECT_NEAR(tracks.velocity_mps[0][1], 1.0, 0.5);
    }
  }
  EXPECT_GT(num_on_him, 120);
  EXPECT_EQ(bus_.last<nodmap::tracks_t>("TRACKS").num_tracks, 0);
}

/// May not leave a square of 8 m.
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

TEST_F(NavigatorNodeGeofence, ItDrivesOnlyWhileItKnowsWhereItIs) {
  run(2.0);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "There is a geofence, and no pose by 2D SLAM.");
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
  EXPECT_EQ(navigation().reason, "There is a geofence, and no pose by 2D SLAM.");
}

TEST_F(NavigatorNodeGeofence, ItBrakesBeforeTheBoundaryAndStandsOutside) {
  run_with_poses(2.0, 1.0);
  ASSERT_TRUE(drives());
  const double front_m = robot::Body{}.footprint().half_length_m;
  EXPECT_NEAR(navigation().clear_distance_m, 4.0 - 1.0 - front_m, 0.02) << "a point each 2 cm";
  run_with_poses(0.1, 4.1);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "The robot is outside of the geofence.");
}

TEST_F(NavigatorNodeGeofence, AGoalOutsideIsNotDrivenTo) {
  nodmap::goal_t goal{};
  goal.is_active = 1;
  goal.position_m[0] = 5.0;
  goal.tolerance_m = 0.3;
  bus_.deliver("GOAL", goal);
  run_with_poses(2.0);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "The goal is outside of the geofence.");
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").state, nodmap::path_t::NO_PATH);
}

TEST_F(NavigatorNodeTest, WithoutAnyMapItHaltsWithTheReason) {
  give_odometry(now_us_);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "There is no obstacle map.");
}

TEST_F(NavigatorNodeTest, AStalledServoHaltsWithTheNextOdometry) {
  run(1.5);
  give_state(now_us_, true);
  give_odometry(now_us_ + 10'000);
  EXPECT_TRUE(halts());
}

TEST_F(NavigatorNodeTest, AStopHaltsWithTheNextOdometryUntilItIsReleased) {
  run(1.5);
  ASSERT_TRUE(drives());
  nodmap::stop_t stop{};
  stop.is_stopped = 1;
  stop.requested_by = "a test";
  bus_.deliver("STOP", stop);
  give_odometry(now_us_ + 10'000);
  EXPECT_TRUE(halts());
  EXPECT_EQ(navigation().reason, "Stopped by a test.");
  nodmap::goal_t goal{};
  goal.is_active = 1;
  goal.position_m[0] = 5.0;
  goal.tolerance_m = 0.3;
  bus_.deliver("GOAL", goal);
  run(10.0);
  EXPECT_TRUE(halts());
  stop.is_stopped = 0;
  bus_.deliver("STOP", stop);
  run(2.0);
  EXPECT_TRUE(drives());
}

// Somebody sends one ODOMETRY that counts anew and is stamped far ahead; later the clock is set
// back by an hour, just after the base driver was started anew. Each costs a moment and not the
// drive.
TEST_F(NavigatorNodeTest, AFarStampOfAnOdometryFrameDoesNotHaltItForGood) {
  run(1.5);
  ASSERT_TRUE(drives());
  auto forged =
      node::write_odometry(time::from_utime(std::int64_t{1} << 59), geometry::SE3::Identity());
  forged.odometry_seq = 0;
  bus_.deliver("ODOMETRY", forged);
  run(2.0);
  EXPECT_TRUE(drives());
  odometry_seq_ = 0;
  tick();
  now_us_ -= 900'000'000;  // the test's clock is younger than an hour
  run(3.0);
  EXPECT_TRUE(drives());
}

// Somebody else promises that the robot may drive at 5 m/s: which of the two means well is not
// known.
TEST_F(NavigatorNodeTest, TwoSendersOfPitchCommandHaltItUntilOneHasEnded) {
  run(1.5);
  ASSERT_TRUE(drives());
  nodmap::pitch_command_t forged{};
  forged.pitch_max_rad = 0.5;
  forged.pitch_min_rad = 0.4;
  forged.sweep_s = 1.0;
  forged.max_forward_mps = 5.0;
  for (int i = 0; i < 50; ++i) {
    forged.utime = now_us_ + 1'000;
    forged.command_seq = 100'000 + i;
    bus_.deliver("PITCH_COMMAND", forged);
    tick();
    EXPECT_LE(drive().forward_mps, 1.0);
    EXPECT_TRUE(i < 5 || halts()) << i;
  }
  EXPECT_EQ(navigation().reason, "Two processes send PITCH_COMMAND.");
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(rejected("other_sender_of_pitch_command"), 50);
  run(3.0);
  EXPECT_TRUE(drives());
}

// Odometry that tells of a robot that stands would let it drive on for ever.
TEST_F(NavigatorNodeTest, ASecondSenderOfAnySensorHaltsItUntilItHasEnded) {
  run(1.5);
  ASSERT_TRUE(drives());
  const std::map<std::string, std::function<void(std::int64_t)>> forgers{
      {"ODOMETRY",
       [this](std::int64_t seq) {
         auto forged = node::write_odometry(time::from_utime(now_us_), geometry::SE3::Identity());
         forged.odometry_seq = seq;
         bus_.deliver("ODOMETRY", forged);
       }},
      {"PITCH_STATE",
       [this](std::int64_t seq) {
         nodmap::pitch_state_t forged{};
         forged.utime = now_us_;
         forged.state_seq = seq;
         bus_.deliver("PITCH_STATE", forged);
       }},
      {"SCAN", [this](std::int64_t seq) {
         scan::Scan scan;
         scan.stamp = time::from_utime(now_us_) - 10ms;
         scan.angle_step_rad = 0.01;
         scan.range_max_m = 30.0;
         scan.ranges_m.assign(181, 30.0F);
         for (const std::int64_t own_or_forged : {seq - 100'000, seq}) {
           scan.seq = own_or_forged;
           bus_.deliver("SCAN", node::write_scan(scan));
         }
       }}};
  for (const auto& [channel, forge] : forgers) {
    for (std::int64_t i = 0; i < 50; ++i) {
      forge(100'000 + i);
      tick();
      EXPECT_TRUE(i < 5 || halts()) << channel << " " << i;
    }
    EXPECT_EQ(navigation().reason, "Two processes send " + channel + ".");
    run(3.0);
    EXPECT_TRUE(drives()) << channel;
  }
  EXPECT_EQ(rejected("other_sender_of_odometry"), 50);
  EXPECT_EQ(rejected("other_sender_of_pitch_state"), 50);
  EXPECT_EQ(rejected("other_sender_of_scan"), 50);
}

TEST_F(NavigatorNodeTest, ACorruptMapIsRefused) {
  run(1.5);
  const auto count = bus_.count("DRIVE");
  auto map = empty_map(now_us_);
  map.distance_m[180] = 1.0F;  // its point is NaN
  bus_.deliver("OBSTACLE_MAP", map);
  map = empty_map(now_us_);
  map.orientation[0] = std::numeric_limits<double>::quiet_NaN();
  bus_.deliver("OBSTACLE_MAP", map);
  map = empty_map(std::numeric_limits<std::int64_t>::min());
  bus_.deliver("OBSTACLE_MAP", map);
  EXPECT_EQ(rejected("implausible_obstacle_map"), 3);
  EXPECT_EQ(bus_.count("DRIVE"), count);
  run(0.11, kMap);
  EXPECT_TRUE(halts());
}

TEST_F(NavigatorNodeTest, MapsFromTheFutureOrThePastHaltOnlyUntilTheNextGoodOne) {
  run(1.5);
  bus_.deliver("OBSTACLE_MAP", empty_map(now_us_ + 3'600'000'000));
  EXPECT_TRUE(halts());
  bus_.deliver("OBSTACLE_MAP", empty_map(now_us_ - 3'600'000'000));
  EXPECT_TRUE(halts());
  run(1.5);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, ClocksThatStepBackAllTogetherAreFollowed) {
  run(1.5);
  now_us_ -= 60'000'000;
  tick();
  EXPECT_TRUE(halts() || drive().forward_mps == 0.0);
  run(2.0);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, AnImplausibleBoundIsRefused) {
  run(1.5);
  give_command(now_us_, std::numeric_limits<double>::quiet_NaN());
  give_command(now_us_, -1.0);
  EXPECT_EQ(rejected("implausible_pitch_command"), 2);
  tick();
  EXPECT_LE(drive().forward_mps, 1.0);
}

TEST_F(NavigatorNodeTest, ObeysThePitchControllersBound) {
  run(1.5);
  EXPECT_EQ(drive().forward_mps, 1.0);
  give_command(now_us_, 0.3);
  bus_.deliver("OBSTACLE_MAP", empty_map(now_us_));
  EXPECT_EQ(drive().forward_mps, 0.3);
}

TEST_F(NavigatorNodeTest, OdometryThatBeganAnewNeedsANewMap) {
  run(1.5);
  run(0.3, kOdometry);  // a process takes longer to start
  odometry_seq_ = 0;
  x_ = 100.0;
  give_odometry(now_us_ + 10'000);
  EXPECT_TRUE(halts());
  bus_.deliver("OBSTACLE_MAP", empty_map(now_us_));  // made in the former frame
  EXPECT_EQ(rejected("map_of_former_odometry"), 1);
  run(1.5);
  EXPECT_TRUE(drives());
}

// As from somebody else on the network, while the base driver is alive.
TEST_F(NavigatorNodeTest, OneOdometryThatBeginsAnewInTheFutureIsRefused) {
  run(1.5);
  auto forged =
      node::write_odometry(time::from_utime(now_us_ + 3'600'000'000), geometry::SE3::Identity());
  forged.odometry_seq = 0;
  bus_.deliver("ODOMETRY", forged);
  EXPECT_EQ(rejected("other_sender_of_odometry"), 1);
  tick();
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, ABaseThatStartsAnewBeforeTheClockIsSetBackIsFollowed) {
  run(1.5);
  odometry_seq_ = 0;
  tick();
  now_us_ -= 600'000'000;
  run(2.0);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, AMapTooFarFromOdometryHalts) {
  run(1.5);
  x_ = 50.0;
  give_odometry(now_us_ + 10'000);
  EXPECT_TRUE(halts());
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
  bus_.deliver("POSE_2D",
               node::write_corrected_pose(time::from_utime(now_us_), geometry::to_se3({0, 1, 0}),
                                          geometry::to_se3({0, 1, 0})));
  tick();
  EXPECT_NEAR(navigation().steering_angle_rad, 0.0, 1e-9);
  x_ = 2.9;
  odometry_seq_ = 0;  // set down there: odometry begins anew
  run(1.5);
  EXPECT_EQ(navigation().behaviour, nodmap::navigation_t::ARRIVED);
  EXPECT_EQ(drive().forward_mps, 0.0);
  goal.tolerance_m = 0.0;
  bus_.deliver("GOAL", goal);
  EXPECT_EQ(rejected("implausible_goal"), 1);
  goal.is_active = false;
  bus_.deliver("GOAL", goal);
  run(0.1);
  EXPECT_TRUE(drives());
}

TEST_F(NavigatorNodeTest, RangesOfTheBaseNeedOdometryAndMayBeAnything) {
  nodmap::base_sensors_t message{};
  message.utime = now_us_;
  bus_.deliver("BASE_SENSORS", message);
  EXPECT_EQ(counts_.rejected().at("base_sensors_without_odometry"), 1);
  give_odometry(now_us_);
  for (const float range_m : {std::numeric_limits<float>::quiet_NaN(), -1e30F, 1e30F,
                              std::numeric_limits<float>::infinity(), 0.3F}) {
    const std::int64_t used = counts_.used();
    std::ranges::fill(message.infrared_m, range_m);
    bus_.deliver("BASE_SENSORS", message);
    EXPECT_EQ(counts_.used(), used + 1) << range_m;
  }
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

// Without a goal the place in the map does not matter.
TEST_F(NavigatorNodeTest, ToAGoalItSlowsWhenThePoseIsDegradedAndHaltsWhenItIsLost) {
  const auto give_pose = [this](std::int8_t state, double variance_m2 = 0.0) {
    auto pose = node::write_corrected_pose(time::from_utime(now_us_), geometry::SE3::Identity(),
                                           geometry::SE3::Identity());
    pose.state = state;
    // Half a metre along a corridor that runs diagonally in map, nothing across.
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

}  // namespace node_test
}  // namespace nodmap::navigator
