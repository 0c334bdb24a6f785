// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/robots.hpp"

#include "tools/trial/level_scanner_node.hpp"

namespace nodmap::trial {
namespace {

// Clearpath Robotics' data sheet and its description for Gazebo.
constexpr double kLengthM = 0.508;
constexpr double kWidthM = 0.430;
constexpr double kHeightM = 0.33;  // with the laser
constexpr double kLaserXM = 0.12;
constexpr double kLaserZM = 0.29;
constexpr double kAxisM = 0.376;
constexpr double kTopSpeedMps = 2.0;
constexpr double kMassKg = 17.0;
constexpr double kMotorPowerW = 250.0;

void set_body(robot::RobotParams& robot) {
  robot.body = {.length_m = kLengthM, .width_m = kWidthM, .height_m = kHeightM};
  robot.mount = {.x_m = kLaserXM, .y_m = 0.0, .z_m = kLaserZM};
}

void set_simulator(sim::SimulatedRobotParams& robot) {
  sim::RobotModelParams& model = robot.model;
  model.body.length_m = kLengthM;
  model.body.width_m = kWidthM;
  model.body.height_m = kHeightM;
  model.drive.mass_kg = kMassKg;
  model.drive.motor_power_w = kMotorPowerW;
  model.drive.top_speed_mps = kTopSpeedMps;
  model.drive.axis_length_m = kAxisM;
  model.drive.turning_adaptation = 1.0;  // two driven wheels and a castor
  model.servo.mount_x_m = kLaserXM;
  model.servo.mount_z_m = kLaserZM;
  model.laser.max_range_m = LevelScannerNode::kRangeMaxM;
  robot.base.base.has_infrared = false;
}

}  // namespace

void set_robot(Robot robot, AllParams& params) {
  if (robot == Robot::kKurt3d) {
    return;
  }
  set_simulator(params.sim);
  set_body(params.navigator.robot);
  set_body(params.map_server.robot);
  set_body(params.pitch_controller.robot);
  set_body(params.explorer.robot);
  params.kurt.wheels.axis_m = kAxisM;
  params.kurt.wheels.turning_adaptation = 1.0;
  params.kurt.limits.max_speed_mps = kTopSpeedMps;
  params.navigator.drive.max_forward_mps = kTopSpeedMps;
  params.pitch_controller.mode = pitch_controller::Mode::kFixed;
  params.pitch_controller.speed.top_mps = kTopSpeedMps;
  params.pitch_controller.detection.scan_period_s = time::seconds(LevelScannerNode::kScanPeriod);
}

}  // namespace nodmap::trial
