// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/robots.hpp"

#include <gtest/gtest.h>

namespace nodmap::trial {
namespace robots_test {

// The same body everywhere, as for KURT3D.
TEST(Robots, EveryPartIsMadeForTheJackal) {
  AllParams params;
  set_robot(Robot::kJackal, params);
  const sim::RobotModelParams& model = params.sim.model;
  EXPECT_EQ(model.body.length_m, 0.508);
  EXPECT_EQ(model.body.width_m, 0.430);
  EXPECT_EQ(model.drive.top_speed_mps, 2.0);
  for (const robot::RobotParams* robot : {&params.navigator.robot, &params.map_server.robot,
                                          &params.pitch_controller.robot, &params.explorer.robot}) {
    EXPECT_EQ(robot->body.length_m, model.body.length_m);
    EXPECT_EQ(robot->body.width_m, model.body.width_m);
    EXPECT_EQ(robot->mount.x_m, model.servo.mount_x_m);
    EXPECT_EQ(robot->mount.z_m, model.servo.mount_z_m);
  }
  EXPECT_EQ(params.kurt.wheels.axis_m, model.drive.axis_length_m);
  EXPECT_EQ(params.kurt.wheels.turning_adaptation, model.drive.turning_adaptation);
}

// Its only sensors are laser, odometry and an IMU.
TEST(Robots, OnlyKurt3dHasInfraredRangeFinders) {
  AllParams params;
  EXPECT_TRUE(params.sim.base.base.has_infrared);
  set_robot(Robot::kJackal, params);
  EXPECT_FALSE(params.sim.base.base.has_infrared);
}

}  // namespace robots_test
}  // namespace nodmap::trial
