// SPDX-License-Identifier: BSD-3-Clause
// The gyro in the whole driver: frames of the base in, odometry out.
#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angle.hpp"
#include "drivers/kurt/test/kurt_robot.hpp"

namespace nodmap::kurt {
namespace gyro_robot_test {

using kurt_robot::Robot;

double yaw_deg(const Robot& robot) {
  return geometry::rad_to_deg(robot.samples.back().state.T_odom_base.yaw);
}

// Rotates by what the wheels take for 57 degrees.
void rotate(Robot& robot) {
  robot.run_for(5s);
  robot.drive_for(0.0, 0.5, 2s);
  robot.run_for(1s);
  robot.drive_for(0.0, 0.0, 1s);
}

TEST(GyroRobot, TheHeadingOfOdometryIsThatOfTheGyro) {
  for (const double ratio : {0.97, 1.0, 1.05}) {
    Robot robot;
    robot.base.gyro_ratio = ratio;
    rotate(robot);
    EXPECT_GT(robot.base.gyro_deg, 40.0);
    EXPECT_NEAR(yaw_deg(robot), robot.base.gyro_deg, 1e-4) << ratio;
    EXPECT_EQ(robot.kurt.gyro().use(), GyroUse::kUsed);
  }
}

// 25.6 degrees to the left, by the words of the frame: 0x079DDAE0 is 127785696.
TEST(GyroRobot, AnAngleIsThatOfItsBytes) {
  Robot robot;
  robot.run_for(1s);
  robot.receive(
      "t00E800000000"
      "00000000\r");
  robot.step();
  robot.receive("t00E8079DDAE000000000\r");
  EXPECT_NEAR(geometry::rad_to_deg(robot.kurt.sensors().gyro->value.yaw_rad), 127785696 / 4992511.0,
              1e-9);
}

// Otherwise a delayed process would compare the gyro with wheels of another time.
TEST(GyroRobot, FramesThatArriveTogetherGiveTheSameHeading) {
  Robot at_once;
  Robot held_up;
  at_once.base.gyro_ratio = held_up.base.gyro_ratio = 0.97;
  for (Robot* robot : {&at_once, &held_up}) {
    robot->run_for(5s);
    robot->drive_for(0.0, 0.5, 1s);
    if (robot == &held_up) {
      robot->held_up_periods = 8;
    }
    robot->drive_for(0.0, 0.5, 500ms);
  }
  EXPECT_NEAR(yaw_deg(held_up), yaw_deg(at_once), 1e-9);
}

TEST(GyroRobot, LostEncoderFramesDoNotTurnTheHeading) {
  Robot robot;
  robot.base.gyro_ratio = 1.0;
  robot.run_for(5s);
  robot.drive_for(0.0, 0.5, 1s);
  robot.base.drop_encoders = 5;
  robot.drive_for(0.0, 0.5, 2s);
  robot.drive_for(0.0, 0.0, 1s);
  // What the five frames rotated, 1.4 degrees, is counted by the gyro; it is not added again when
  // the loss is noticed.
  EXPECT_NEAR(yaw_deg(robot), robot.base.gyro_deg, 0.3);
  EXPECT_GT(robot.kurt.counts().encoder_lost, 0);
}

TEST(GyroRobot, AStalledWheelDoesNotTurnIt) {
  Robot robot;
  robot.base.gyro_ratio = 1.0;
  robot.run_for(5s);
  robot.base.stalled = true;
  robot.drive_for(0.0, 0.5, 1s);
  EXPECT_EQ(yaw_deg(robot), 0.0);
  EXPECT_EQ(fault_of(robot.kurt.gyro().use()), "");
}

// After the line was lost the motion meanwhile is unknown, to gyro and wheels alike: the pose
// stays.
TEST(GyroRobot, ALossOfTheLineIsNoRotation) {
  Robot robot;
  robot.base.gyro_ratio = 1.0;
  rotate(robot);
  const double before_deg = yaw_deg(robot);
  robot.kurt.disconnected();
  robot.base.gyro_deg += 40.0;
  robot.kurt.connected(robot.moment());
  robot.run_for(2s);
  EXPECT_NEAR(yaw_deg(robot), before_deg, 1e-6);
}

}  // namespace gyro_robot_test
}  // namespace nodmap::kurt
