// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/params.hpp"

#include <gtest/gtest.h>

#include "common/robot/robot_params.hpp"

namespace nodmap::trial {
namespace params_test {

// R6: KURT3D as in the paper, II; every part uses the same body.
TEST(AllParams, R6_EveryPartIsMadeForTheSameRobot) {
  const AllParams params;
  const sim::RobotModelParams& model = params.sim.model;
  EXPECT_EQ(model.body.length_m, 0.45);
  EXPECT_EQ(model.body.width_m, 0.33);
  EXPECT_EQ(model.body.height_m, 0.47);
  EXPECT_EQ(model.drive.mass_kg, 22.6);
  EXPECT_EQ(model.drive.top_speed_mps, 5.2);
  EXPECT_EQ(model.drive.motor_power_w, 90.0);

  // The simulator has its own values, as an independent check; all other parts share RobotParams.
  const robot::RobotParams robot = params.navigator.robot;
  EXPECT_EQ(robot.body.length_m, model.body.length_m);
  EXPECT_EQ(robot.body.width_m, model.body.width_m);
  EXPECT_EQ(robot.body.height_m, model.body.height_m);
  EXPECT_EQ(robot.mount.x_m, model.servo.mount_x_m);
  EXPECT_EQ(robot.mount.z_m, model.servo.mount_z_m);
  EXPECT_EQ(params.laser3d.mirror.forward_m, model.servo.mirror_forward_m);
  EXPECT_EQ(params.laser3d.mirror.up_m, model.servo.mirror_up_m);
}

}  // namespace params_test
}  // namespace nodmap::trial
