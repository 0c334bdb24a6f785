// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/senders.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "common/node/messages.hpp"
#include "modules/navigator/test/navigator_node.hpp"

namespace nodmap::navigator {
namespace senders_test {

using test::NavigatorNodeTest;

// Another sender sends one ODOMETRY whose sequence begins anew and whose stamp is far in the
// future. Later the base driver restarts and the clock is set back by a quarter of an hour. After
// each of them the robot drives on within seconds.
TEST_F(NavigatorNodeTest, OneOdometryWithAFarFutureStampDoesNotHaltItForGood) {
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

// A second sender allows 5 m/s. The navigator cannot know which of the two is legitimate.
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

// A false ODOMETRY of a stationary robot, for example, would let it drive on for ever.
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
      {"SCAN",
       [this](std::int64_t seq) {
         scan::Scan scan;
         scan.stamp = time::from_utime(now_us_) - 10ms;
         scan.angle_step_rad = 0.01;
         scan.range_max_m = 30.0;
         scan.ranges_m.assign(181, 30.0F);
         for (const std::int64_t own_or_forged : {seq - 100'000, seq}) {
           scan.seq = own_or_forged;
           bus_.deliver("SCAN", node::write_scan(scan));
         }
       }},
      {"OBSTACLE_MAP",
       [this](std::int64_t seq) {
         auto forged = empty_map(now_us_);
         forged.scan_seq = seq;
         bus_.deliver("OBSTACLE_MAP", forged);
       }},
      {"BASE_SENSORS", [this](std::int64_t seq) {
         nodmap::base_sensors_t sensors{};
         sensors.utime = now_us_;
         for (const std::int64_t own_or_forged : {seq - 100'000, seq}) {
           sensors.sensors_seq = own_or_forged;
           bus_.deliver("BASE_SENSORS", sensors);
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
  EXPECT_EQ(rejected("other_sender_of_obstacle_map"), 50);
  EXPECT_EQ(rejected("other_sender_of_base_sensors"), 50);
}

// It sends seldom, but with numbers that the base driver has not reached yet: 20 ms after the
// third message that is refused the robot halts.
TEST_F(NavigatorNodeTest, ASecondSenderOfOdometryThatListensHaltsIt) {
  run(1.5);
  ASSERT_TRUE(drives());
  for (int i = 0; i < 50; ++i) {
    auto forged = node::write_odometry(time::from_utime(now_us_), geometry::SE3::Identity());
    forged.odometry_seq = odometry_seq_ + 99;
    bus_.deliver("ODOMETRY", forged);
    run(0.05);
    EXPECT_TRUE(halts()) << i;
    EXPECT_EQ(navigation().reason, "Two processes send ODOMETRY.");
    run(0.16);
  }
  run(3.0);
  EXPECT_TRUE(drives());
}

// A second process repeats all messages of the first, with the next numbers, and reports that
// nothing is near and that the robot stands still. At each message that it gets in, its numbers
// would be right.
TEST_F(NavigatorNodeTest, ASecondProcessThatCopiesTheNumbersHaltsItAndIsNotBelieved) {
  const bus::Origin own{{0x7F000001, 40'000}, {}};
  const bus::Origin other{{0x7F000001, 40'001}, {}};
  bus_.set_origin(own);
  run(1.5);
  ASSERT_TRUE(drives());
  for (int i = 0; i < 50; ++i) {
    bus_.set_origin(other);
    const auto [odometry, map, command, state] =
        std::tuple(odometry_seq_, map_seq_, command_seq_, state_seq_);
    tick();
    std::tie(odometry_seq_, map_seq_, command_seq_, state_seq_) =
        std::tuple(odometry, map, command, state);
    bus_.set_origin(own);
    tick();
    EXPECT_TRUE(i < 5 || halts()) << i;
  }
  for (const char* cause : {"other_sender_of_odometry", "other_sender_of_obstacle_map",
                            "other_sender_of_pitch_command", "other_sender_of_pitch_state"}) {
    EXPECT_EQ(rejected(cause), 50) << cause;
  }
  run(3.0);
  EXPECT_TRUE(drives());
}

// Too seldom to be noticed: nothing of it is used.
TEST_F(NavigatorNodeTest, ASecondProcessThatSendsSeldomHasNoEffect) {
  const bus::Origin own{{0x7F000001, 40'000}, {}};
  bus_.set_origin(own);
  run(1.5);
  for (int i = 0; i < 5; ++i) {
    bus_.set_origin({{0x7F000001, 40'001}, {}});
    give_command(now_us_, 0.1);
    --command_seq_;
    bus_.set_origin(own);
    run(1.0);
    EXPECT_TRUE(drives()) << i;
  }
  EXPECT_EQ(rejected("other_sender_of_pitch_command"), 5);
}

// Somebody else on the network sends it while the base driver runs.
TEST_F(NavigatorNodeTest, OneOdometryThatBeginsAnewWithAFutureStampIsRefused) {
  run(1.5);
  auto forged =
      node::write_odometry(time::from_utime(now_us_ + 3'600'000'000), geometry::SE3::Identity());
  forged.odometry_seq = 0;
  bus_.deliver("ODOMETRY", forged);
  EXPECT_EQ(rejected("unconfirmed_odometry"), 1);
  tick();
  EXPECT_TRUE(drives());
}

// The name is repeated in each NAVIGATION.
TEST_F(NavigatorNodeTest, AStopWithALongNameIsNotRepeatedAtThatLength) {
  run(1.5);
  nodmap::stop_t stop{};
  stop.is_stopped = 1;
  stop.requested_by = std::string(250'000, 'x');
  bus_.deliver("STOP", stop);
  run(0.1);
  EXPECT_TRUE(halts());
  EXPECT_LT(navigation().reason.size(), 200U);
}

}  // namespace senders_test
}  // namespace nodmap::navigator
