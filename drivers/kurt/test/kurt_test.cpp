// SPDX-License-Identifier: BSD-3-Clause
// The driver's core against the emulated base, on simulated time: no port, no message, no waiting.
#include "drivers/kurt/kurt.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "drivers/kurt/test/kurt_robot.hpp"

namespace nodmap::kurt {
namespace kurt_test {

using kurt_robot::kStart;
using kurt_robot::Robot;

TEST(Kurt, OpensTheBusAndIsStationaryUntilDriven) {
  Robot robot;
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoBus);
  robot.run_for(500ms);
  EXPECT_TRUE(robot.base.channel_open());
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoDrive);
  EXPECT_GT(robot.base.commands(), 20);
  EXPECT_FALSE(robot.base.braked());
  EXPECT_EQ(robot.base.left_cm_s(), 0);
  EXPECT_EQ(robot.base.nonsense(), 0);
}

TEST(Kurt, DrivesAndMeasuresWhatItDrives) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.5, 4s);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kDriving);
  const OdometryState& state = robot.samples.back().state;
  // Commands have steps of 1 cm/s: 0.005 m/s per wheel, and 0.005 / 0.2 rad/s.
  EXPECT_NEAR(state.forward_mps, 1.0, 0.006);
  EXPECT_NEAR(state.yaw_rate_rad_s, 0.5, 0.03);
  EXPECT_GT(state.T_odom_base.y, 0.0);
  EXPECT_EQ(robot.kurt.counts().encoder_lost, 0);
}

TEST(Kurt, OdometryIsStampedWithTheWallClockEveryTenMilliseconds) {
  Robot robot;
  robot.run_for(2s);
  ASSERT_GT(robot.samples.size(), 100U);
  for (std::size_t i = 1; i < robot.samples.size(); ++i) {
    EXPECT_EQ(robot.samples[i].stamp - robot.samples[i - 1].stamp, 10ms);
  }
  EXPECT_EQ(robot.samples.back().stamp, kStart + robot.now.time_since_epoch());
}

TEST(Kurt, WithoutDriveTheWheelsStopWithinTheTimeoutAndOneFrame) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 2s);
  ASSERT_EQ(robot.base.left_cm_s(), 100);
  const time::SteadyTime silent_since = robot.now - 10ms;  // the last DRIVE
  while (robot.base.left_cm_s() != 0 && robot.now < silent_since + 1s) {
    robot.step();
  }
  EXPECT_LE(robot.now - silent_since, 210ms);
  EXPECT_EQ(robot.base.right_cm_s(), 0);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoDrive);
  // And on again with the next one, from standstill within the limits.
  robot.drive_for(1.0, 0.0, 10ms);
  EXPECT_GT(robot.base.left_cm_s(), 0);
  EXPECT_LE(robot.base.left_cm_s(), 2);
}

TEST(Kurt, ADriveThatIsNotFiniteStopsTheRobotWithTheNextFrame) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 1s);
  ASSERT_EQ(robot.base.left_cm_s(), 100);
  EXPECT_EQ(robot.drive(std::numeric_limits<double>::quiet_NaN(), 0.0), DriveStatus::kNotFinite);
  robot.step();
  EXPECT_EQ(robot.base.left_cm_s(), 0);
}

// A safety stop is not limited, also if the navigator's next DRIVE is received before the next
// control period.
TEST(Kurt, ADriveRightAfterASafetyStopMakesNoRampOfIt) {
  const auto touch_bumper = [](Robot& robot) {
    robot.receive("t00A20400\r");
    EXPECT_EQ(robot.kurt.take_alarm(), Alarm::kBumper);
  };
  const auto send_nonsense = [](Robot& robot) {
    EXPECT_EQ(robot.drive(std::numeric_limits<double>::quiet_NaN(), 0.0), DriveStatus::kNotFinite);
  };
  for (const std::function<void(Robot&)>& safety_stop :
       {std::function<void(Robot&)>(touch_bumper), {send_nonsense}}) {
    Robot robot;
    robot.run_for(500ms);
    robot.drive_for(1.0, 0.0, 1s);
    ASSERT_EQ(robot.base.left_cm_s(), 100);
    safety_stop(robot);
    EXPECT_EQ(robot.drive(0.0, 0.0), DriveStatus::kObeyed);
    robot.step();
    EXPECT_EQ(robot.base.left_cm_s(), 0);
  }
}

// Not even the command that was valid when the alarm was raised moves it.
TEST(Kurt, AfterAnAlarmTheRobotWaitsForANewDrive) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 1s);
  robot.receive("t00A20400\r");  // the bumper
  ASSERT_EQ(robot.kurt.take_alarm(), Alarm::kBumper);
  for (int i = 0; i < 10; ++i) {
    robot.step();
    EXPECT_EQ(robot.base.left_cm_s(), 0);
  }
}

TEST(Kurt, WhatTheSonarSeesSlowsItDown) {
  Robot robot;
  robot.run_for(500ms);
  robot.base.sonar_raw = 200;  // 34 cm
  robot.drive_for(1.0, 0.0, 1s);
  // stoppable_speed() within 9 cm, after 0.1 s, at half of the wheels' 3 m/s^2
  EXPECT_EQ(robot.base.left_cm_s(), 39);
  robot.base.sonar_raw = 900;
  robot.drive_for(1.0, 0.0, 1s);
  EXPECT_EQ(robot.base.left_cm_s(), 100);
}

TEST(Kurt, ATiltedBaseRaisesTheAlarm) {
  Robot robot;
  robot.run_for(500ms);
  for (int i = 0; i <= 50; ++i) {
    EXPECT_FALSE(robot.kurt.take_alarm());
    robot.receive("t00D88F5C800000000000\r");  // 0.98 g: 78 degrees
    robot.step();
  }
  EXPECT_EQ(robot.kurt.take_alarm(), Alarm::kTilt);
  EXPECT_EQ(robot.kurt.lasting_alarm(), Alarm::kTilt);
}

TEST(Kurt, OtherSensorsAreKeptWithTheirTime) {
  Robot robot;
  robot.run_for(500ms);
  const BaseSensors& sensors = robot.kurt.sensors();
  ASSERT_TRUE(sensors.sonar_raw.has_value());
  EXPECT_EQ(sensors.sonar_raw->value, 900);
  EXPECT_EQ(sensors.sonar_raw->at, robot.now);
  EXPECT_EQ(sensors.infrared_raw[static_cast<int>(Infrared::kRightFront)]->value, 300);
  EXPECT_FALSE(sensors.infrared_raw[static_cast<int>(Infrared::kBack)].has_value());
  EXPECT_FALSE(sensors.tilt.has_value());
}

TEST(Kurt, TheShutdownCommandIsTheHardStop) {
  EXPECT_EQ(Kurt::shutdown_command(), "t001800000103FF0103FF\r");
}

TEST(Kurt, R6_TheDefaultsAreTheRobots) {
  EXPECT_EQ(kTopSpeedMps, 5.2);
  EXPECT_EQ(KurtParams{}.limits.max_speed_mps, 5.2);
}

}  // namespace kurt_test
}  // namespace nodmap::kurt
