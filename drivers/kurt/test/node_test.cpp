// SPDX-License-Identifier: BSD-3-Clause
// The whole driver in one process: messages over memq://, bytes over a pseudo-terminal, the
// emulated base behind it. The test sets the time; it waits only for bytes to pass through the
// terminal.
#include "drivers/kurt/node.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/node/status.hpp"
#include "drivers/kurt/test/kurt_emulator.hpp"
#include "nodmap/base_sensors_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/status_t.hpp"
#include "tests/support/pty_pair.hpp"

namespace nodmap::kurt {
namespace node_test {

constexpr time::Timestamp kStart{1'700'000'000s};
constexpr std::size_t kCommandBytes = 22;

/// Waits until `count` bytes have made it through the terminal.
void await_input(int fd, std::size_t count) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  int waiting = 0;
  while (::ioctl(fd, FIONREAD, &waiting) == 0 && static_cast<std::size_t>(waiting) < count &&
         std::chrono::steady_clock::now() < deadline) {
    pollfd entry{fd, POLLIN, 0};
    ::poll(&entry, 1, 1);
  }
}

class Bench {
 public:
  Bench() : odometry(bus, "ODOMETRY"), sensors(bus, "BASE_SENSORS"), status(bus, "STATUS") {}

  void step() {
    now += 10ms;
    clock.advance(10ms);
    const std::string to_driver = answer_ + (pty ? base.tick() : "");
    answer_.clear();
    if (pty && node->poll_handles()[0] >= 0 && !to_driver.empty()) {
      pty->send(to_driver);
      await_input(node->poll_handles()[0], to_driver.size());
    }
    bus.handle(std::chrono::milliseconds(0));
    node->spin_once();
    reporter.publish_if_due(*node);
    bus.handle(std::chrono::milliseconds(0));
    if (pty) {
      // Once the bus is open there is a command in every period.
      const bool command_comes = base.channel_open() && node->poll_handles()[0] >= 0;
      answer_ = base.take(pty->receive_text(command_comes ? kCommandBytes : 0,
                                            std::chrono::milliseconds(command_comes ? 100 : 1)));
    }
  }

  template <class Condition>
  bool step_until(Condition condition, time::Duration at_most) {
    for (const time::SteadyTime end = now + at_most; now < end && !condition();) {
      step();
    }
    return condition();
  }

  void publish_drive(double forward_mps, double yaw_rate_rad_s) {
    nodmap::drive_t message{};
    message.utime = time::to_utime(clock.now());
    message.drive_seq = drive_seq++;
    message.forward_mps = forward_mps;
    message.yaw_rate_rad_s = yaw_rate_rad_s;
    message.valid_us = 1'000'000;
    bus.publish("DRIVE", message);
  }

  void drive_for(double forward_mps, double yaw_rate_rad_s, time::Duration duration) {
    for (const time::SteadyTime end = now + duration; now < end;) {
      publish_drive(forward_mps, yaw_rate_rad_s);
      step();
    }
  }

  void publish_stop(bool is_stopped, const std::string& by = "test") {
    nodmap::stop_t message{};
    message.is_stopped = static_cast<std::int8_t>(is_stopped);
    message.requested_by = by;
    bus.publish("STOP", message);
  }

  void restart() {
    node.reset();
    base = {};
    node.emplace(context, KurtParams{}, open, [this] { return time::Moment{clock.now(), now}; });
  }

  /// The line is open, and the robot is free to drive.
  bool stands_ready() {
    publish_stop(false);
    return step_until([this] { return node->health().state == node::HealthState::kDegraded; }, 1s);
  }

  time::SteadyTime now;
  std::int64_t drive_seq = 0;
  time::ManualClock clock{kStart};
  std::optional<test::PtyPair> pty{std::in_place};
  test::KurtEmulator base;
  bus::LiveBus bus{"memq://"};
  bus::Latest<nodmap::odometry_t> odometry;
  bus::Latest<nodmap::base_sensors_t> sensors;
  bus::Latest<nodmap::status_t> status;
  node::MessageCounts counts;
  node::Context context{bus, counts, {}};
  serial::SerialLink::Opener open = [this]() -> serial::OpenResult {
    if (!pty) {
      return {nullptr, "/dev/kurt: No such file or directory"};
    }
    return serial::open_serial_port({pty->name()});
  };
  std::optional<KurtNode> node{std::in_place, context, KurtParams{}, open, [this] {
                                 return time::Moment{clock.now(), now};
                               }};
  node::StatusReporter reporter{"nodmap-kurt", bus, counts, clock};

 private:
  std::string answer_;
};

TEST(KurtNode, DriveMovesTheBaseAndOdometryComesBack) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(0.5, 0.4, 2s);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kOk);
  EXPECT_EQ(bench.base.nonsense(), 0);
  EXPECT_GT(bench.base.right_cm_s(), bench.base.left_cm_s());
  ASSERT_TRUE(bench.odometry.get().has_value());
  const nodmap::odometry_t& odometry = *bench.odometry.get();
  EXPECT_NEAR(odometry.forward_mps, 0.5, 0.006);  // 1 cm/s is the step of a command
  EXPECT_NEAR(odometry.yaw_rate_rad_s, 0.4, 0.03);
  EXPECT_GT(odometry.orientation[3], 0.0);  // to the left
  EXPECT_GT(odometry.pose_covariance[0][0], 0.0);
  EXPECT_GT(odometry.pose_covariance[5][5], 0.0);
  EXPECT_EQ(odometry.pose_covariance[0][5], odometry.pose_covariance[5][0]);
  EXPECT_EQ(odometry.utime, time::to_utime(bench.clock.now()));
  EXPECT_EQ(odometry.odometry_seq, bench.odometry.count() - 1);
}

TEST(KurtNode, OtherSensorsArePublished) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  ASSERT_TRUE(bench.step_until([&] { return bench.sensors.count() >= 2; }, 200ms));
  const nodmap::base_sensors_t& message = *bench.sensors.get();
  EXPECT_EQ(message.sonar_raw, 900);
  EXPECT_NEAR(message.sonar_m, 1.115099F, 1e-6F);
  EXPECT_EQ(message.infrared_raw[static_cast<int>(Infrared::kRightFront)], 300);
  EXPECT_EQ(message.infrared_raw[static_cast<int>(Infrared::kBack)], -1);
  EXPECT_TRUE(std::isnan(message.infrared_m[static_cast<int>(Infrared::kBack)]));
  EXPECT_TRUE(std::isnan(message.roll_rad));
}

TEST(KurtNode, WithoutDriveTheBaseIsTold_ZeroWithinTheTimeoutAndOneFrame) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(1.0, 0.0, 1500ms);
  ASSERT_EQ(bench.base.left_cm_s(), 100);
  const time::SteadyTime last_drive = bench.now - 10ms;
  ASSERT_TRUE(bench.step_until([&] { return bench.base.left_cm_s() == 0; }, 1s));
  EXPECT_LE(bench.now - last_drive, 210ms + 10ms);  // and a step for the terminal
  EXPECT_EQ(bench.node->health().state, node::HealthState::kDegraded);
}

TEST(KurtNode, ATouchedBumperStopsItUntilReleased) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(1.0, 0.0, 1500ms);
  ASSERT_EQ(bench.base.left_cm_s(), 100);
  bench.base.bumper = true;
  bench.drive_for(1.0, 0.0, 50ms);  // zero at once, without a ramp
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_NE(bench.node->health().reason.find("bumper"), std::string::npos);
  bench.base.bumper = false;
  bench.drive_for(1.0, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  bench.publish_stop(false);
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
}

TEST(KurtNode, StalledMotorsAreNotLeftUnderCurrent) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.base.stalled = true;
  bench.drive_for(0.5, 0.0, 2500ms);  // 2 s from the first command of 5 cm/s on
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_NE(bench.node->health().reason.find("stalled"), std::string::npos);
}

TEST(KurtNode, WhileStoppedItIgnoresDriveUntilReleased) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(1.0, 0.0, 1500ms);
  ASSERT_EQ(bench.base.left_cm_s(), 100);
  bench.publish_stop(true);
  // 1 m/s at 3 m/s^2, and a step each for message and terminal.
  bench.drive_for(1.0, 0.0, 360ms);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  bench.drive_for(0.5, 0.5, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_EQ(bench.base.right_cm_s(), 0);
  bench.publish_stop(false);
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
}

// Base driver and navigator were killed and restarted. Whether the robot had been stopped before is
// unknown, so it starts stopped.
TEST(KurtNode, AfterEachStartItIsStoppedUntilReleased) {
  Bench bench;
  bench.drive_for(0.5, 0.0, 2s);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kDegraded);
  EXPECT_NE(bench.node->health().reason.find("stopped by its start"), std::string::npos)
      << bench.node->health().reason;
  bench.publish_stop(false);
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
  bench.publish_stop(true);
  bench.drive_for(0.5, 0.0, 1s);
  bench.restart();
  bench.drive_for(0.5, 0.0, 2s);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
}

// This tells a navigator or viewer that is started later.
TEST(KurtNode, PublishesStopOnceASecondUntilReleased) {
  Bench bench;
  const bus::Latest<nodmap::stop_t> stop(bench.bus, "STOP");
  bench.drive_for(0.0, 0.0, 3500ms);
  EXPECT_EQ(stop.count(), 3);
  EXPECT_EQ(stop.get()->is_stopped, 1);
  EXPECT_EQ(stop.get()->requested_by, "nodmap-kurt, for its start");
  bench.publish_stop(false);
  bench.publish_stop(true, "nodmap-kurt, for its start");  // overtaken on the network
  bench.drive_for(0.5, 0.0, 3s);
  EXPECT_EQ(stop.count(), 5);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
}

// Names that resemble the driver's own stop it as well, and their length is not repeated.
TEST(KurtNode, AStopByAnyNameStopsIt) {
  for (const std::string& by :
       {std::string("nodmap-kurt"), "nodmap-kurt, for " + std::string(250'000, 'x')}) {
    Bench bench;
    ASSERT_TRUE(bench.stands_ready());
    const bus::Latest<nodmap::stop_t> stop(bench.bus, "STOP");
    bench.drive_for(0.5, 0.0, 1s);
    ASSERT_EQ(bench.base.left_cm_s(), 50);
    bench.publish_stop(true, by);
    bench.drive_for(0.5, 0.0, 3s);
    EXPECT_EQ(bench.base.left_cm_s(), 0);
    EXPECT_LE(stop.count(), 4) << "once a second";
    EXPECT_LT(stop.get()->requested_by.size(), 150U);
  }
}

// A second sender of DRIVE: faster, and stamped ahead of the clock.
TEST(KurtNode, ASecondSenderOfDriveStopsTheRobotAndIsReported) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(0.5, 0.0, 1s);
  ASSERT_EQ(bench.base.left_cm_s(), 50);
  nodmap::drive_t forged{};
  forged.drive_seq = 100'000;
  forged.forward_mps = 5.0;
  forged.valid_us = 1'000'000;
  for (int i = 0; i < 100; ++i) {
    forged.utime = time::to_utime(bench.clock.now()) + 4'000;
    ++forged.drive_seq;
    bench.bus.publish("DRIVE", forged);
    bench.drive_for(0.5, 0.0, 10ms);
    EXPECT_LE(bench.base.left_cm_s(), 50);
  }
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kFailed);
  EXPECT_NE(bench.node->health().reason.find("two processes send DRIVE"), std::string::npos);
  EXPECT_GE(bench.counts.rejected().at("drive_other_sender"), 100);
  bench.drive_for(0.5, 0.0, 2s);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kOk);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
}

TEST(KurtNode, RefusedCommandsAreCountedByCause) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.publish_drive(std::numeric_limits<double>::quiet_NaN(), 0.0);
  bench.publish_drive(1000.0, 0.0);
  nodmap::drive_t stale{};
  stale.utime = time::to_utime(bench.clock.now()) - 300'000;
  stale.drive_seq = bench.drive_seq++;
  stale.valid_us = 1'000'000;
  bench.bus.publish("DRIVE", stale);
  const std::int64_t used = bench.counts.used();
  bench.publish_drive(0.1, 0.0);
  bench.step();
  EXPECT_EQ(bench.counts.used(), used + 1);
  EXPECT_EQ(bench.counts.rejected().at("drive_not_finite"), 1);
  EXPECT_EQ(bench.counts.rejected().at("drive_implausible"), 1);
  EXPECT_EQ(bench.counts.rejected().at("drive_stale"), 1);
}

TEST(KurtNode, TheEndIsAHardStop) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(0.5, 0.0, 1s);
  ASSERT_FALSE(bench.base.braked());
  bench.node->finish();
  bench.base.take(bench.pty->receive_text(kCommandBytes));
  EXPECT_TRUE(bench.base.braked());
  EXPECT_EQ(bench.node->poll_handles()[0], -1);
  bench.node->spin_once();  // does not open it again
  EXPECT_EQ(bench.node->poll_handles()[0], -1);
}

// As when the process ends by an exception.
TEST(KurtNode, EveryExitIsAHardStop) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(0.5, 0.0, 1s);
  ASSERT_FALSE(bench.base.braked());
  bench.node.reset();
  bench.base.take(bench.pty->receive_text(kCommandBytes));
  EXPECT_TRUE(bench.base.braked());
}

TEST(KurtNode, APulledPlugIsReportedAndRecoveredFrom) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(0.5, 0.0, 1s);
  bench.pty.reset();
  bench.drive_for(0.5, 0.0, 20ms);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kFailed);
  EXPECT_EQ(bench.node->health().reason, "the line is disconnected");
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.node->health().reason, "/dev/kurt: No such file or directory");
  EXPECT_EQ(bench.status.get()->health, nodmap::status_t::FAILED);
  EXPECT_EQ(bench.status.get()->process_name, "nodmap-kurt");

  bench.base = {};
  bench.pty.emplace();
  // The pause between attempts is at most 1.6 s after 1 s, the opening takes 0.2 s.
  ASSERT_TRUE(bench.step_until(
      [&] { return bench.node->health().state == node::HealthState::kDegraded; }, 2s));
  EXPECT_EQ(bench.base.left_cm_s(), 0);  // waits for a new DRIVE
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
  EXPECT_EQ(bench.node->metrics()["reconnects"], 1);
}

TEST(KurtNode, ABaseThatSendsNothingPlausibleIsFailedAndNoOdometryIsPublished) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.drive_for(0.5, 0.0, 1s);
  bench.base.wild_encoders = 1000;
  bench.drive_for(0.5, 0.0, 250ms);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kFailed);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  const auto told = bench.odometry.count();
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.odometry.count(), told);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
}

TEST(KurtNode, AMuteAdapterIsFailedAndThePortIsOpenedAgain) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  bench.base.mute_adapter = true;
  ASSERT_TRUE(bench.step_until(
      [&] { return bench.node->health().state == node::HealthState::kFailed; }, 500ms));
  ASSERT_TRUE(bench.step_until([&] { return bench.node->metrics()["reconnects"] >= 1; }, 4s));
  bench.base.mute_adapter = false;
  EXPECT_TRUE(bench.step_until(
      [&] { return bench.node->health().state == node::HealthState::kDegraded; }, 10s));
}

TEST(KurtNode, ALineThatAcceptsNoBytesIsGivenUp) {
  Bench bench;
  ASSERT_TRUE(bench.stands_ready());
  // Nothing reads on the device's side, so the terminal fills up.
  for (int i = 0; i < 5000 && bench.node->poll_handles()[0] >= 0; ++i) {
    bench.now += 10ms;
    bench.clock.advance(10ms);
    bench.pty->send(bench.base.tick());
    await_input(bench.node->poll_handles()[0], 1);
    bench.node->spin_once();
  }
  EXPECT_EQ(bench.node->health().state, node::HealthState::kFailed);
  EXPECT_EQ(bench.node->health().reason, "the line does not accept bytes");
}

}  // namespace node_test
}  // namespace nodmap::kurt
