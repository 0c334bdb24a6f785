// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/sensor_input.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "common/node/messages.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::node {
namespace sensor_input_test {

nodmap::scan_t good_scan(std::int64_t seq) {
  scan::Scan scan;
  scan.stamp = time::from_utime(1'000'000);
  scan.seq = seq;
  scan.angle_step_rad = 0.1;
  scan.range_max_m = 10.0;
  scan.ranges_m = {1.0F, 2.0F};
  return node::write_scan(scan);
}

class SensorInputTest : public ::testing::Test {
 protected:
  test::MemoryBus bus_;
  node::MessageCounts counts_;
  SensorInput input_{counts_, &bus_};
  scan::Scan scan_;
};

TEST_F(SensorInputTest, GoodMessagesPassUncounted) {
  EXPECT_TRUE(input_.read(good_scan(0), scan_));
  EXPECT_EQ(scan_.ranges_m.size(), 2U);
  EXPECT_TRUE(input_.read(node::write_odometry(time::from_utime(1), geometry::SE3::Identity()))
                  .has_value());
  EXPECT_EQ(counts_.total_rejected(), 0);
  EXPECT_EQ(counts_.used(), 0);
}

TEST_F(SensorInputTest, CausesAreCounted) {
  nodmap::scan_t scan = good_scan(0);
  scan.num_ranges = 0;
  scan.ranges_m.clear();
  EXPECT_FALSE(input_.read(scan, scan_));
  EXPECT_EQ(counts_.rejected().at("empty_scan"), 1);
  for (const std::int64_t utime :
       {std::int64_t{-1}, std::numeric_limits<std::int64_t>::max(), std::int64_t{1} << 60}) {
    scan = good_scan(0);
    scan.utime = utime;
    EXPECT_FALSE(input_.read(scan, scan_));
  }
  scan = good_scan(0);
  scan.beam_duration_us = 60'000'001;
  EXPECT_FALSE(input_.read(scan, scan_));
  EXPECT_EQ(counts_.rejected().at("implausible_scan"), 4);
  EXPECT_FALSE(input_.read(nodmap::odometry_t{}).has_value());  // never filled in
  const nodmap::odometry_t good =
      node::write_odometry(time::from_utime(1), geometry::SE3::Identity());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [forward_mps, yaw_rate_rad_s] :
       {std::pair{20.1, 0.0}, {-20.1, 0.0}, {nan, 0.0}, {0.0, 50.1}, {0.0, -50.1}, {0.0, nan}}) {
    nodmap::odometry_t odometry = good;
    odometry.forward_mps = forward_mps;
    odometry.yaw_rate_rad_s = yaw_rate_rad_s;
    EXPECT_FALSE(input_.read(odometry).has_value()) << forward_mps << ' ' << yaw_rate_rad_s;
  }
  EXPECT_EQ(counts_.rejected().at("implausible_odometry"), 7);
  nodmap::odometry_t fastest = good;
  fastest.forward_mps = -20.0;
  fastest.yaw_rate_rad_s = 50.0;
  EXPECT_TRUE(input_.read(fastest).has_value());
}

TEST_F(SensorInputTest, GapsInEitherStreamAreLosses) {
  EXPECT_TRUE(input_.read(good_scan(5), scan_));
  EXPECT_TRUE(input_.read(good_scan(8), scan_));
  EXPECT_EQ(counts_.lost(), 2);
  nodmap::odometry_t odometry =
      node::write_odometry(time::from_utime(1), geometry::SE3::Identity());
  EXPECT_TRUE(input_.read(odometry).has_value());
  odometry.odometry_seq = 2;
  EXPECT_TRUE(input_.read(odometry).has_value());
  EXPECT_EQ(counts_.lost(), 3);
}

// Every second message is of another process, which knows the next number.
TEST_F(SensorInputTest, OneSocketIsFollowedUntilItIsSilent) {
  const bus::Sender own{0x7F000001, 40'000};
  const bus::Sender other{0x7F000001, 40'001};
  time::SteadyTime now{24h};
  const auto reads = [&](const bus::Sender& sender, std::int64_t seq) {
    // The wall clock is set an hour forwards or back with each message: it says nothing.
    bus_.set_origin({sender, time::Timestamp{seq % 2 * 1h}, now});
    nodmap::odometry_t odometry =
        node::write_odometry(time::Timestamp{24h}, geometry::SE3::Identity());
    odometry.odometry_seq = seq;
    const bool reads_scan = input_.read(good_scan(seq), scan_);
    EXPECT_EQ(input_.read(odometry).has_value(), reads_scan);
    nodmap::egomap_t structure_map{};
    structure_map.utime = time::to_utime(time::Timestamp{24h});
    structure_map.distance_m = structure_map.point_x_m = {1.0F};
    structure_map.point_y_m = {0.0F};
    EXPECT_EQ(input_.read(structure_map).has_value(), reads_scan);
    return reads_scan;
  };
  for (std::int64_t seq = 0; seq < 100; ++seq, now += 10ms) {
    EXPECT_TRUE(reads(own, seq));
    EXPECT_FALSE(reads(other, seq + 1));
  }
  EXPECT_EQ(counts_.rejected().at("other_sender_of_scan"), 100);
  EXPECT_EQ(counts_.rejected().at("other_sender_of_odometry"), 100);
  EXPECT_EQ(counts_.rejected().at("other_sender_of_structure_map"), 100);
  EXPECT_EQ(counts_.lost(), 0);
  now += bus::SenderWatch::kSilence - 11ms;
  EXPECT_FALSE(reads(other, 100));
  now += 1ms;
  EXPECT_TRUE(reads(other, 100));
}

class OdometryInputTest : public SensorInputTest {
 public:
  static constexpr time::Timestamp kDay{24h};

 protected:
  bool read(std::int64_t seq, time::Timestamp stamp = kDay, const geometry::SE2& pose = {}) {
    nodmap::odometry_t odometry = node::write_odometry(stamp, geometry::to_se3(pose));
    odometry.odometry_seq = seq;
    return input_.read(odometry).has_value();
  }
  // Whether the message is used as the first of a new frame, or of the same one.
  bool restarts(std::int64_t seq, time::Timestamp stamp = kDay, const geometry::SE2& pose = {}) {
    EXPECT_TRUE(read(seq, stamp, pose)) << seq;
    return input_.odometry_restarted();
  }
};

TEST_F(OdometryInputTest, LowerNumbersAreThoseOfARestartedDriver) {
  EXPECT_FALSE(restarts(7));  // the first message
  EXPECT_FALSE(restarts(8));
  EXPECT_FALSE(restarts(8));   // a publisher that does not number its messages
  EXPECT_FALSE(restarts(12));  // a loss is not a restart
  EXPECT_FALSE(read(0)) << "not until the next message confirms it";
  EXPECT_TRUE(restarts(1));
  EXPECT_FALSE(restarts(50));
  EXPECT_FALSE(restarts(51));

  // The first message of the new frame cannot be used, so the next ones count.
  nodmap::odometry_t no_pose{};
  no_pose.odometry_seq = 0;
  EXPECT_FALSE(input_.read(no_pose).has_value());
  EXPECT_FALSE(read(1));
  EXPECT_TRUE(restarts(2));
  EXPECT_EQ(counts_.lost(), 3 + 48);
  EXPECT_EQ(counts_.rejected().at("unconfirmed_odometry"), 2);
}

TEST_F(OdometryInputTest, ADriverMayRestartAfterItsFirstMessages) {
  EXPECT_FALSE(restarts(0));
  EXPECT_FALSE(restarts(1));
  EXPECT_FALSE(read(0));
  EXPECT_TRUE(restarts(1));
  EXPECT_FALSE(restarts(2));
}

TEST_F(OdometryInputTest, OneForgedMessageCostsNoOther) {
  std::int64_t seq = 5000;
  time::Timestamp stamp = kDay;
  ASSERT_FALSE(restarts(seq, stamp));
  for (const int ahead : {-4000, 1, 2, 100, 1'000'000}) {
    for (const time::Timestamp forged : {time::Timestamp{}, stamp, kDay + 24h}) {
      static_cast<void>(read(seq + ahead, forged));
      EXPECT_FALSE(restarts(++seq, stamp += 10ms)) << ahead << " " << time::to_utime(forged);
      EXPECT_FALSE(restarts(++seq, stamp += 10ms)) << ahead << " " << time::to_utime(forged);
    }
    EXPECT_FALSE(read(seq + ahead, kDay + 24h));
    EXPECT_FALSE(restarts(++seq, stamp += 10ms));
  }
}

// Every 10 ms there is a message, but the receiver is busy for a while.
TEST_F(OdometryInputTest, TellsForHowLongMessagesWereLost) {
  std::int64_t seq = 1000;
  time::Timestamp stamp = kDay;
  const auto lost = [&](std::int64_t messages, time::Duration elapsed) {
    EXPECT_TRUE(read(seq += messages, stamp += elapsed));
    return input_.odometry_lost();
  };
  EXPECT_EQ(lost(0, 0ms), 0ms) << "the first one";
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(lost(1, 10ms), 0ms);
  }
  EXPECT_EQ(lost(501, 5010ms), 5000ms);
  EXPECT_EQ(lost(1, 5s), 0ms) << "the driver was silent";
  // The mean period is 18.3 ms by now: 602 messages in 11.01 s.
  EXPECT_EQ(lost(101, 5s), 1'828'904us) << "silent for the rest of the time";
  EXPECT_EQ(lost(1000, 2s), 2s) << "no more than the time that has passed";
}

// So long that the first message after it must be confirmed.
TEST_F(OdometryInputTest, TellsForHowLongAllMessagesWereLost) {
  ASSERT_TRUE(read(0, kDay));
  ASSERT_TRUE(read(100, kDay + 1s));
  EXPECT_FALSE(read(3000, kDay + 30s));
  EXPECT_TRUE(read(3001, kDay + 30'010ms));
  EXPECT_EQ(input_.odometry_lost(), 29s);
}

// It has counted from 0 again, meanwhile farther than before. The motion before is unknown.
TEST_F(OdometryInputTest, ADriverThatRestartsUnnoticedHasNotLostAllMessages) {
  ASSERT_TRUE(read(0, kDay));
  ASSERT_TRUE(read(500, kDay + 5s));
  EXPECT_FALSE(read(2000, kDay + 30s));
  EXPECT_TRUE(read(2001, kDay + 30'010ms));
  EXPECT_EQ(input_.odometry_lost(), 15s) << "of 25 s";
}

// The clock of the driver's host is set.
TEST_F(OdometryInputTest, AStepOfTheClockCostsOneMessage) {
  ASSERT_FALSE(restarts(1, kDay));
  EXPECT_FALSE(read(2, kDay + 1h));
  EXPECT_FALSE(restarts(3, kDay + 1h + 10ms));
  EXPECT_FALSE(read(4, kDay));
  EXPECT_FALSE(restarts(5, kDay + 10ms));
  EXPECT_FALSE(restarts(6, kDay + 9s)) << "the driver was frozen";
}

// A gyro that is zeroed, or a fused pose that is corrected: in 10 ms no robot gets there.
TEST_F(OdometryInputTest, APoseThatJumpsBeginsANewFrame) {
  std::int64_t seq = 1;
  time::Timestamp stamp = kDay;
  ASSERT_FALSE(restarts(seq, stamp));
  geometry::SE2 pose;
  for (const geometry::SE2 jump : {geometry::SE2{0.0, 0.0, geometry::deg_to_rad(12.0)},
                                   geometry::SE2{0.3, 0.0, 0.0}, geometry::SE2{-500.0, 0.0, 3.0}}) {
    pose = pose * jump;
    EXPECT_FALSE(read(++seq, stamp += 10ms, pose)) << "not until the next message confirms it";
    EXPECT_TRUE(restarts(++seq, stamp += 10ms, pose));
    EXPECT_FALSE(restarts(++seq, stamp += 10ms, pose));
  }
}

TEST_F(OdometryInputTest, AWildPoseCostsNoOtherMessage) {
  ASSERT_FALSE(restarts(1, kDay));
  EXPECT_FALSE(read(2, kDay + 10ms, {3.0, 0.0, 1.0}));
  EXPECT_FALSE(restarts(3, kDay + 20ms, {0.02, 0.0, 0.0}));
}

// The first of each two messages is stamped when the second one is sent.
TEST_F(OdometryInputTest, ALateStampIsNoJump) {
  std::int64_t seq = 1;
  geometry::SE2 pose;
  ASSERT_FALSE(restarts(seq, kDay));
  for (time::Timestamp stamp = kDay; stamp < kDay + 2s; stamp += 200ms) {
    pose = pose * geometry::SE2{0.05, 0.0, geometry::deg_to_rad(6.0)};
    EXPECT_FALSE(restarts(++seq, stamp + 199'900us, pose));
    pose = pose * geometry::SE2{0.05, 0.0, geometry::deg_to_rad(6.0)};
    EXPECT_FALSE(restarts(++seq, stamp + 200ms, pose));
  }
}

// 5.2 m/s and a turn of 3 rad/s, from a base that reports no speeds: every 10 ms, ten times a
// second, and with a second of messages lost.
TEST_F(OdometryInputTest, AFastRobotDoesNotJump) {
  std::int64_t seq = 1;
  time::Timestamp stamp = kDay;
  geometry::SE2 pose;
  ASSERT_FALSE(restarts(seq, stamp));
  for (const time::Duration elapsed : {10ms, 100ms, 1000ms}) {
    for (int i = 0; i < 20; ++i) {
      const double seconds = time::seconds(elapsed);
      pose = pose * geometry::SE2{5.2 * seconds, 0.0, 3.0 * seconds};
      EXPECT_FALSE(restarts(++seq, stamp += elapsed, pose)) << seconds << " s";
    }
  }
}

}  // namespace sensor_input_test
}  // namespace nodmap::node
