// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/params.hpp"

#include <gtest/gtest.h>

#include "common/robot/robot_params.hpp"

namespace nodmap::trial {
namespace {

// R6: KURT3D as in the paper, II; and every part of the robot is made for that body.
TEST(AllParams, R6_EveryPartIsMadeForTheSameRobot) {
  const AllParams params;
  const sim::PlantParams& plant = params.sim.plant;
  EXPECT_EQ(plant.body_length_m, 0.45);
  EXPECT_EQ(plant.body_width_m, 0.33);
  EXPECT_EQ(plant.body_height_m, 0.47);
  EXPECT_EQ(plant.mass_kg, 22.6);
  EXPECT_EQ(plant.top_speed_mps, 5.2);
  EXPECT_EQ(plant.motor_power_w, 90.0);

  // The simulator is its own witness and has its own figures; all the others share RobotParams.
  const robot::RobotParams robot = params.navigator.robot;
  EXPECT_EQ(robot.body.length_m, plant.body_length_m);
  EXPECT_EQ(robot.body.width_m, plant.body_width_m);
  EXPECT_EQ(robot.body.height_m, plant.body_height_m);
  EXPECT_EQ(robot.mount.x_m, plant.mount_x_m);
  EXPECT_EQ(robot.mount.z_m, plant.mount_z_m);
}

}  // namespace
}  // namespace nodmap::trial
