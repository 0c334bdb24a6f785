// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/inputs/senders.hpp"

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

constexpr bus::Sender kOther{0x7F000001, 40'001};

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
    forged.command_seq = 90'000 + i;
    bus_.deliver_from(kOther, "PITCH_COMMAND", forged);
    tick();
    EXPECT_LE(drive().forward_mps, 1.0);
    EXPECT_TRUE(i < 5 || halts()) << i;
  }
  EXPECT_EQ(navigation().reason, "Two processes send PITCH_COMMAND.");
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(rejected("other_sender_of_pitch_command"), 50);
  EXPECT_EQ(counts_.lost(), 0) << "their numbers show no loss";
  run(3.0);
  EXPECT_TRUE(drives());
}

// A false ODOMETRY of a stationary robot, for example, would let it drive on for ever.
TEST_F(NavigatorNodeTest, ASecondSenderOfAnySensorHaltsItUntilItHasEnded) {
  run(1.5);
  ASSERT_TRUE(drives());
  const std::map<std::string, std::function<void()>> forgers{
      {"ODOMETRY",
       [this] {
         auto forged = node::write_odometry(time::from_utime(now_us_), geometry::SE3::Identity());
         forged.odometry_seq = odometry_seq_;
         bus_.deliver_from(kOther, "ODOMETRY", forged);
       }},
      {"PITCH_STATE",
       [this] {
         nodmap::pitch_state_t forged{};
         forged.utime = now_us_;
         bus_.deliver_from(kOther, "PITCH_STATE", forged);
       }},
      {"SCAN",
       [this] {
         scan::Scan scan;
         scan.stamp = time::from_utime(now_us_) - 10ms;
         scan.angle_step_rad = 0.01;
         scan.range_max_m = 30.0;
         scan.ranges_m.assign(181, 30.0F);
         bus_.deliver("SCAN", node::write_scan(scan));
         bus_.deliver_from(kOther, "SCAN", node::write_scan(scan));
       }},
      {"OBSTACLE_MAP", [this] { bus_.deliver_from(kOther, "OBSTACLE_MAP", empty_map(now_us_)); }},
      {"BASE_SENSORS", [this] {
         nodmap::base_sensors_t sensors{};
         sensors.utime = now_us_;
         bus_.deliver("BASE_SENSORS", sensors);
         bus_.deliver_from(kOther, "BASE_SENSORS", sensors);
       }}};
  for (const auto& [channel, forge] : forgers) {
    for (int i = 0; i < 50; ++i) {
      forge();
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

// A second process repeats all messages of the first, with the next numbers, and reports that
// nothing is near and that the robot is stationary. At each message that it gets in, its numbers
// would be right.
TEST_F(NavigatorNodeTest, ASecondProcessThatCopiesTheNumbersHaltsItAndIsNotBelieved) {
  run(1.5);
  ASSERT_TRUE(drives());
  for (int i = 0; i < 50; ++i) {
    send_as(kOther);
    const auto [odometry, map, command, state] =
        std::tuple(odometry_seq_, map_seq_, command_seq_, state_seq_);
    tick();
    std::tie(odometry_seq_, map_seq_, command_seq_, state_seq_) =
        std::tuple(odometry, map, command, state);
    send_as({});
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

// As when the power of all devices fails: neither driver sends while the other one starts.
TEST_F(NavigatorNodeTest, DriversThatRestartTogetherAreFollowedAgain) {
  run(1.5);
  ASSERT_TRUE(drives());
  send_as(kOther);
  odometry_seq_ = 0;
  state_seq_ = 0;
  run(3.0);
  EXPECT_TRUE(drives());
}

// Too seldom to be noticed: nothing of it is used.
TEST_F(NavigatorNodeTest, ASecondProcessThatSendsSeldomHasNoEffect) {
  run(1.5);
  for (int i = 0; i < 5; ++i) {
    send_as(kOther);
    give_command(now_us_, 0.1);
    --command_seq_;
    send_as({});
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
