// SPDX-License-Identifier: BSD-3-Clause
// What the driver does with DRIVE and STOP, and what it publishes.
#include "drivers/kurt/node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "drivers/kurt/test/node_bench.hpp"

namespace nodmap::kurt {
namespace node_test {

TEST(KurtNode, DriveMovesTheBaseAndOdometryComesBack) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.4, 2s);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kOk);
  EXPECT_EQ(bench.base.nonsense(), 0);
  EXPECT_GT(bench.base.right_cm_s(), bench.base.left_cm_s());
  ASSERT_TRUE(bench.odometry.get().has_value());
  const nodmap::odometry_t& odometry = *bench.odometry.get();
  EXPECT_NEAR(odometry.forward_mps, 0.5, 0.006);  // 1 cm/s is the step of a command
  // Each wheel is half a step off at most.
  const WheelParams wheels;
  EXPECT_NEAR(odometry.yaw_rate_rad_s, 0.4, 0.01 / wheels.axis_m * wheels.turning_adaptation);
  EXPECT_GT(odometry.orientation[3], 0.0);  // to the left
  // The path is an arc, apart from the time in which the robot accelerates.
  const double yaw_rad = 2.0 * std::atan2(odometry.orientation[3], odometry.orientation[0]);
  const double chord_m = std::hypot(odometry.position_m[0], odometry.position_m[1]);
  const double path_m = chord_m * 0.5 * yaw_rad / std::sin(0.5 * yaw_rad);
  const OdometryNoiseParams noise;
  const double yaw_variance = noise.heading_sigma_rad * noise.heading_sigma_rad * path_m +
                              noise.rotation_sigma_rad * noise.rotation_sigma_rad * yaw_rad;
  EXPECT_NEAR(odometry.pose_covariance[5][5], yaw_variance, 1e-3 * yaw_variance);
  // A wrong heading moves the robot aside by the whole path at most.
  const double position_variance = odometry.pose_covariance[0][0] + odometry.pose_covariance[1][1];
  const double along_variance = noise.distance_sigma_m * noise.distance_sigma_m * path_m;
  EXPECT_GT(position_variance, along_variance);
  EXPECT_LT(position_variance, along_variance + path_m * path_m * yaw_variance);
  EXPECT_EQ(odometry.pose_covariance[0][5], odometry.pose_covariance[5][0]);
  EXPECT_EQ(odometry.utime, time::to_utime(bench.clock.now()));
  EXPECT_EQ(odometry.odometry_seq, bench.odometry.count() - 1);
}

TEST(KurtNode, OtherSensorsArePublished) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  ASSERT_TRUE(bench.step_until([&] { return bench.sensors.count() >= 2; }, 200ms));
  const nodmap::base_sensors_t& message = *bench.sensors.get();
  EXPECT_EQ(message.sonar_raw, 900);
  EXPECT_NEAR(message.sonar_m, 1.115099F, 1e-6F);
  EXPECT_EQ(message.infrared_raw[static_cast<int>(Infrared::kRightFront)], 300);
  EXPECT_EQ(message.infrared_raw[static_cast<int>(Infrared::kBack)], -1);
  EXPECT_TRUE(std::isnan(message.infrared_m[static_cast<int>(Infrared::kBack)]));
  EXPECT_TRUE(std::isnan(message.roll_rad));
}

TEST(KurtNode, AnOldReadingIsNotPublished) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  ASSERT_TRUE(bench.step_until([&] { return bench.sensors.count() >= 2; }, 200ms));
  bench.base.ranges_off = true;
  bench.drive_for(0.0, 0.0, 80ms);
  EXPECT_EQ(bench.sensors.get()->sonar_raw, 900);
  bench.drive_for(0.0, 0.0, 90ms);  // 100 ms, and one period of the message
  EXPECT_EQ(bench.sensors.get()->sonar_raw, -1);
  EXPECT_TRUE(std::isnan(bench.sensors.get()->sonar_m));
}

TEST(KurtNode, ADriveIsObeyedNoLongerThanItSays) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(1.0, 0.0, 1500ms);
  ASSERT_EQ(bench.base.left_cm_s(), 100);
  nodmap::drive_t message{};
  message.utime = time::to_utime(bench.clock.now());
  message.drive_seq = bench.drive_seq++;
  message.forward_mps = 1.0;
  message.valid_us = 50'000;
  bench.bus.publish("DRIVE", message);
  EXPECT_TRUE(bench.step_until([&] { return bench.base.left_cm_s() == 0; }, 70ms));
}

TEST(KurtNode, WithoutDriveTheBaseIsTold_ZeroWithinTheTimeoutAndOneFrame) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(1.0, 0.0, 1500ms);
  ASSERT_EQ(bench.base.left_cm_s(), 100);
  const time::SteadyTime last_drive = bench.now - 10ms;
  ASSERT_TRUE(bench.step_until([&] { return bench.base.left_cm_s() == 0; }, 1s));
  EXPECT_LE(bench.now - last_drive, 210ms + 10ms);  // and a step for the terminal
  EXPECT_EQ(bench.node->health().state, node::HealthState::kDegraded);
}

TEST(KurtNode, ATouchedBumperStopsItUntilReleased) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
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

TEST(KurtNode, ASilentGyroIsReported) {
  Bench bench;
  bench.base.gyro_ratio = 1.0;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.0, 0.0, 4s);
  bench.drive_for(0.2, 0.3, 1s);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kOk);
  EXPECT_GT(bench.node->metrics()["gyro_used"], 0);
  bench.base.gyro_ratio.reset();
  bench.drive_for(0.2, 0.3, 1s);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kDegraded);
  EXPECT_EQ(bench.node->health().reason,
            "the heading comes from the wheels alone: the gyro is silent");
}

TEST(KurtNode, AnAlarmDoesNotHideWhoHasStoppedIt) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.publish_stop(true, "page");
  bench.drive_for(0.0, 0.0, 50ms);
  bench.base.bumper = true;
  bench.drive_for(0.0, 0.0, 50ms);
  EXPECT_NE(bench.node->health().reason.find("page"), std::string::npos)
      << bench.node->health().reason;
}

// At a wall, for example: it must be possible to back off.
TEST(KurtNode, ReleasedWhileItsBumperIsTouchedItCreeps) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.base.bumper = true;
  bench.drive_for(0.5, 0.0, 100ms);
  ASSERT_NE(bench.node->health().reason.find("bumper"), std::string::npos);
  bench.publish_stop(false);
  bench.drive_for(-0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), -10);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kDegraded);
  EXPECT_EQ(bench.node->health().reason, "only creeps because of its bumper");
  bench.base.bumper = false;
  bench.drive_for(-0.5, 0.0, 1s);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kOk);
}

TEST(KurtNode, StalledMotorsAreNotLeftUnderCurrent) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.base.stalled = true;
  bench.drive_for(0.5, 0.0, 2500ms);  // 2 s from the first command of 5 cm/s on
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_NE(bench.node->health().reason.find("stalled"), std::string::npos);
}

TEST(KurtNode, WhileStoppedItIgnoresDriveUntilReleased) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
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

// The navigator may hang, and that may be why somebody stops the robot.
TEST(KurtNode, AStopBrakesAlsoWithoutAnotherDrive) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(1.0, 0.0, 1500ms);
  ASSERT_EQ(bench.base.left_cm_s(), 100);
  bench.publish_stop(true);
  for (int i = 0; i < 5; ++i) {
    bench.step();
  }
  EXPECT_LE(bench.base.left_cm_s(), 90);  // four periods at 3 m/s^2
  EXPECT_GE(bench.base.left_cm_s(), 80);  // and not at once
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

// The copies of a release that was given to a driver that has crashed since. The bench starts the
// driver without the network of a host, where such copies may be.
TEST(KurtNode, AReleaseFromBeforeItsStartIsRefused) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.restart();
  bench.node->refuse_former_releases();
  for (int copy = 0; copy < 3; ++copy) {
    bench.drive_for(0.5, 0.0, 200ms);
    bench.publish_stop(false);
  }
  bench.drive_for(0.5, 0.0, 2s);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_GE(bench.counts.rejected().at("release_from_before_the_start"), 3);
  bench.publish_stop(false);
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
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
  bench.bus.publish("STOP", *stop.get());  // overtaken on the network
  bench.drive_for(0.5, 0.0, 3s);
  EXPECT_EQ(stop.count(), 5);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
}

// nodmap-stop sends a release three times. The second one comes after a STOP of somebody else.
TEST(KurtNode, ARepeatedReleaseDoesNotUndoANewerStop) {
  Bench bench;
  nodmap::stop_t release{};
  release.utime = 5'000'000;
  release.requested_by = "nodmap-stop";
  bench.bus.publish("STOP", release);
  bench.drive_for(0.5, 0.0, 1s);
  ASSERT_EQ(bench.base.left_cm_s(), 50);
  bench.publish_stop(true, "page");
  bench.bus.publish("STOP", release);
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  nodmap::stop_t newer = release;
  newer.utime = 6'000'000;
  bench.bus.publish("STOP", newer);
  bench.drive_for(0.5, 0.0, 1s);
  ASSERT_EQ(bench.base.left_cm_s(), 50);
  bench.publish_stop(true, "page");
  bench.bus.publish("STOP", newer);
  bench.bus.publish("STOP", release);  // the third copy of an older one
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
}

// Names that resemble the driver's own stop it as well, and their length is not repeated.
TEST(KurtNode, AStopByAnyNameStopsIt) {
  for (const std::string& by :
       {std::string("nodmap-kurt"), std::string("nodmap-kurt, for its start"),
        "nodmap-kurt, for " + std::string(250'000, 'x')}) {
    Bench bench;
    ASSERT_TRUE(bench.becomes_ready());
    const bus::Latest<nodmap::stop_t> stop(bench.bus, "STOP");
    bench.drive_for(0.5, 0.0, 1s);
    ASSERT_EQ(bench.base.left_cm_s(), 50);
    bench.publish_stop(true, by);
    bench.drive_for(0.5, 0.0, 3s);
    EXPECT_EQ(bench.base.left_cm_s(), 0);
    EXPECT_LE(stop.count(), 4) << "once a second";
    // Of another base driver's repetition, whoever asked for it is named.
    const std::string prefix = "nodmap-kurt, for ";
    const std::string name = by.substr(0, 100);
    EXPECT_EQ(stop.get()->requested_by, name.starts_with(prefix) ? name : prefix + name);
  }
}

// In the first second the driver has not repeated STOP itself yet.
TEST(KurtNode, AStopWithoutANameStopsItSoonAfterTheStart) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 500ms);
  ASSERT_EQ(bench.base.left_cm_s(), 50);
  bench.publish_stop(true, "");
  bench.drive_for(0.5, 0.0, 500ms);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
}

TEST(KurtNode, RefusedCommandsAreCountedByCause) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
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
  EXPECT_EQ(bench.counts.rejected().at("implausible_drive"), 1);
  EXPECT_EQ(bench.counts.rejected().at("drive_stale"), 1);
}

}  // namespace node_test
}  // namespace nodmap::kurt
