// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "common/node/messages.hpp"
#include "modules/navigator/people/test/walking_scene.hpp"
#include "modules/navigator/test/navigator_node.hpp"

namespace nodmap::navigator {
namespace node_test {

using test::NavigatorNodeScans;
using test::NavigatorNodeTest;

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

TEST_F(NavigatorNodeTest, AStalledServoHaltsAtOnce) {
  run(1.5);
  ASSERT_TRUE(drives());
  give_state(now_us_ + 5'000, true);
  EXPECT_TRUE(halts());
  // While it stays stalled, odometry sets the pace.
  const auto count = bus_.count("DRIVE");
  give_state(now_us_ + 9'000, true);
  EXPECT_EQ(bus_.count("DRIVE"), count);
  give_odometry(now_us_ + 10'000);
  EXPECT_EQ(bus_.count("DRIVE"), count + 1);
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
  nodmap::stop_t release{};
  release.utime = 1;
  bus_.deliver("STOP", release);
  run(2.0);
  EXPECT_TRUE(drives());
  stop.utime = 2;
  bus_.deliver("STOP", stop);
  bus_.deliver("STOP", release);  // a copy
  run(2.0);
  EXPECT_TRUE(halts());
}

// Datagrams 101, 103, 102: the robot drives on, as nothing was forgotten. After a restart of the
// driver, which is believed from its second message on, the robot first looks at two sweeps.
TEST_F(NavigatorNodeTest, OdometryThatWasOvertakenIsNoNewFrame) {
  run(1.5);
  ASSERT_TRUE(drives());
  odometry_seq_ += 1;
  give_odometry(now_us_ + 2'000);
  odometry_seq_ -= 2;
  give_odometry(now_us_ + 1'000);
  odometry_seq_ += 1;
  tick();
  EXPECT_TRUE(drives());
  odometry_seq_ = 0;
  tick();
  tick();
  EXPECT_FALSE(drives());
  run(1.5);
  EXPECT_TRUE(drives());
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

// Exchanged ends would look like a held laser, with which the robot drives over floor that it has
// not seen; the laser driver does not carry out such a sweep.
TEST_F(NavigatorNodeTest, AnImplausibleSweepIsRefused) {
  const nodmap::pitch_command_t good = command(now_us_);
  std::vector<nodmap::pitch_command_t> bad(4, good);
  std::swap(bad[0].pitch_min_rad, bad[0].pitch_max_rad);
  bad[1].pitch_min_rad = std::numeric_limits<double>::quiet_NaN();
  bad[2].pitch_max_rad = std::numeric_limits<double>::infinity();
  bad[3].sweep_s = 0.0;
  for (const auto& each : bad) {
    bus_.deliver("PITCH_COMMAND", each);
  }
  EXPECT_EQ(rejected("implausible_pitch_command"), 4);
  bus_.deliver("PITCH_COMMAND", good);
  EXPECT_EQ(rejected("implausible_pitch_command"), 4);
}

// A sweep before the first would make every direction in view count as seen since then.
TEST_F(NavigatorNodeTest, AnImplausiblePitchStateIsRefused) {
  nodmap::pitch_state_t good{};
  good.utime = now_us_;
  std::vector<nodmap::pitch_state_t> bad(4, good);
  bad[0].sweep_count = -1;
  bad[1].pitch_rad = std::numeric_limits<double>::quiet_NaN();
  bad[2].pitch_rate_rad_s = std::numeric_limits<double>::infinity();
  bad[3].utime = std::numeric_limits<std::int64_t>::min();
  for (const auto& each : bad) {
    bus_.deliver("PITCH_STATE", each);
  }
  EXPECT_EQ(rejected("implausible_pitch_state"), 4);
  bus_.deliver("PITCH_STATE", good);
  EXPECT_EQ(rejected("implausible_pitch_state"), 4);
}

TEST_F(NavigatorNodeTest, AnImplausibleBoundIsRefused) {
  run(1.5);
  give_command(now_us_, std::numeric_limits<double>::quiet_NaN());
  give_command(now_us_, -1.0);
  EXPECT_EQ(rejected("implausible_pitch_command"), 2);
  tick();
  EXPECT_EQ(drive().forward_mps, 1.0);
}

TEST_F(NavigatorNodeTest, ObeysThePitchControllersBound) {
  run(1.5);
  EXPECT_EQ(drive().forward_mps, 1.0);
  give_command(now_us_, 0.3);
  bus_.deliver("OBSTACLE_MAP", empty_map(now_us_));
  EXPECT_EQ(drive().forward_mps, 0.3);
}

TEST_F(NavigatorNodeTest, InfraredRangesAreRefusedWithoutOdometryAndOtherwiseTakenAsTheyAre) {
  nodmap::base_sensors_t message{};
  message.utime = now_us_;
  bus_.deliver("BASE_SENSORS", message);
  EXPECT_EQ(counts_.rejected().at("base_sensors_without_odometry"), 1);
  give_odometry(now_us_);
  for (const float range_m : {std::numeric_limits<float>::quiet_NaN(), -1e30F, 1e30F,
                              std::numeric_limits<float>::infinity(), 0.3F}) {
    const std::int64_t used = counts_.used();
    std::ranges::fill(message.infrared_m, range_m);
    ++message.sensors_seq;
    bus_.deliver("BASE_SENSORS", message);
    EXPECT_EQ(counts_.used(), used + 1) << range_m;
  }
}

// It may have waited while the process was frozen.
TEST_F(NavigatorNodeTest, InfraredRangesOlderThan200MillisecondsAreNotUsed) {
  run(1.5);
  nodmap::base_sensors_t message{};
  message.utime = now_us_ - 200'000;
  bus_.deliver("BASE_SENSORS", message);
  EXPECT_EQ(rejected("stale_base_sensors"), 0);
  --message.utime;
  bus_.deliver("BASE_SENSORS", message);
  EXPECT_EQ(rejected("stale_base_sensors"), 1);
}

class NavigatorNodeRanges : public NavigatorNodeScans {
 protected:
  // Lets the robot look around while it drives at `mps`.
  void drive_for(double duration_s, double mps = 0.3) {
    for (double t = 0.0; t < duration_s; t += 0.01) {
      x_ += 0.01 * mps;
      tick_with(floor_.scan({}, {x_, 0.0, 0.0},
                            test::nodding_pitch_rad(static_cast<double>(now_us_) * 1e-6)));
    }
  }

  void give_range(robot::Infrared sensor, float range_m) {
    nodmap::base_sensors_t message{};
    message.utime = now_us_;
    message.sensors_seq = sensors_seq_++;
    std::ranges::fill(message.infrared_m, std::numeric_limits<float>::quiet_NaN());
    message.infrared_m[static_cast<std::size_t>(sensor)] = range_m;
    bus_.deliver("BASE_SENSORS", message);
  }

  void give_stop(bool is_stopped) {
    nodmap::stop_t stop{};
    stop.is_stopped = is_stopped ? 1 : 0;
    bus_.deliver("STOP", stop);
  }

  test::WalkingScene floor_{{}, 20.0};
  std::int64_t sensors_seq_ = 0;
};

// Somebody steps behind the robot, onto floor that it has driven over, and is gone again.
TEST_F(NavigatorNodeRanges, ItStopsForSomebodyCloseBehindAndThenDrivesOn) {
  drive_for(5.0);
  ASSERT_TRUE(drives());
  give_range(robot::Infrared::kBack, 0.3F);
  tick();
  EXPECT_EQ(drive().forward_mps, 0.0);
  EXPECT_EQ(drive().yaw_rate_rad_s, 0.0);
  EXPECT_EQ(navigation().reason,
            "Somebody is close beside or behind: waits until they have passed.");
  give_range(robot::Infrared::kBack, std::numeric_limits<float>::quiet_NaN());
  drive_for(0.6);
  EXPECT_TRUE(drives());
}

// Somebody comes during a stop, stands against the robot's side and releases it. The goal is
// straight behind, and a rotation in either direction would end on their feet.
TEST_F(NavigatorNodeRanges, AfterAStopItDoesNotRotateIntoWhoeverHasComeMeanwhile) {
  drive_for(5.0);
  give_stop(true);
  nodmap::goal_t goal{};
  goal.is_active = 1;
  goal.position_m[0] = x_ - 1.0;
  goal.tolerance_m = 0.3;
  bus_.deliver("GOAL", goal);
  const auto look_for = [&](double duration_s, float left_m) {
    double fastest_rad_s = 0.0;
    for (double t = 0.0; t < duration_s; t += 0.05) {
      give_range(robot::Infrared::kLeft, left_m);
      drive_for(0.05, 0.0);
      if (drive().forward_mps == 0.0) {
        fastest_rad_s = std::max(fastest_rad_s, std::abs(drive().yaw_rate_rad_s));
      }
    }
    return fastest_rad_s;
  };
  ASSERT_EQ(look_for(2.0, 0.0F), 0.0);
  give_stop(false);
  EXPECT_EQ(look_for(3.0, 0.0F), 0.0);
  EXPECT_GT(look_for(3.0, std::numeric_limits<float>::quiet_NaN()), 0.0) << "they have gone";
}

}  // namespace node_test
}  // namespace nodmap::navigator
