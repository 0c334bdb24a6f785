// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/robots.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "common/geometry/angle.hpp"
#include "common/node/messages.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {
namespace {

/// A Hokuyo UST-10LX: 40 revolutions per second; it measures during three quarters of each.
constexpr time::Duration kScanPeriod = 25ms;
constexpr time::Duration kMeasuringTime = 18'750us;
constexpr std::size_t kBeams = 720;
constexpr double kApertureRad = geometry::deg_to_rad(270.0);
constexpr double kRangeMinM = 0.06;
constexpr double kRangeMaxM = 30.0;
/// Time until the first scan.
constexpr time::Duration kBootTime = 1s;

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

void set_simulator(sim::RobotModelParams& model) {
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
  model.laser.max_range_m = kRangeMaxM;
}

}  // namespace

void set_robot(Robot robot, AllParams& params) {
  if (robot == Robot::kKurt3d) {
    return;
  }
  set_simulator(params.sim.model);
  set_body(params.navigator.robot);
  set_body(params.map_server.robot);
  set_body(params.pitch_controller.robot);
  params.kurt.wheels.axis_m = kAxisM;
  params.kurt.wheels.turning_adaptation = 1.0;
  params.kurt.limits.max_speed_mps = kTopSpeedMps;
  params.navigator.drive.max_forward_mps = kTopSpeedMps;
  params.pitch_controller.mode = pitch_controller::Mode::kFixed;
  params.pitch_controller.speed.top_mps = kTopSpeedMps;
  params.pitch_controller.detection.scan_period_s = time::seconds(kScanPeriod);
}

LevelScannerNode::LevelScannerNode(node::Context& context, const robot::Mount& mount,
                                   sim::RobotModel& model)
    : context_(context), mount_(mount), model_(model), next_scan_(model.now() + kBootTime) {}

void LevelScannerNode::spin_once() {
  const time::SteadyTime now = model_.now();
  if (now < next_scan_) {
    return;
  }
  publish_pitch(now);
  publish_scan(now);
  ++seq_;
  next_scan_ += kScanPeriod;
}

void LevelScannerNode::publish_scan(time::SteadyTime end) {
  scan::Scan scan;
  scan.stamp = stamp_at(end - kMeasuringTime);
  scan.duration = kMeasuringTime;
  scan.seq = seq_;
  scan.angle_first_rad = -0.5 * kApertureRad;
  scan.angle_step_rad = kApertureRad / static_cast<double>(kBeams - 1);
  scan.range_min_m = kRangeMinM;
  scan.range_max_m = kRangeMaxM;
  scan.T_base_mount.translation() << mount_.x_m, mount_.y_m, mount_.z_m;
  scan.ranges_m.resize(kBeams);
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    const auto since_first = std::chrono::duration_cast<time::Duration>(
        scan.fraction(beam) * time::FineDuration(kMeasuringTime));
    const sim::Echo echo = model_.measure(scan.angle_rad(beam), end - kMeasuringTime + since_first);
    scan.ranges_m[beam] = echo.kind == sim::Echo::Kind::kRange
                              ? static_cast<float>(echo.range_m)
                              : std::numeric_limits<float>::infinity();
  }
  context_.bus.publish("SCAN", node::write_scan(scan));
}

void LevelScannerNode::publish_pitch(time::SteadyTime now) {
  nodmap::pitch_state_t message{};
  message.utime = time::to_utime(stamp_at(now));
  message.state_seq = seq_;
  message.pitch_is_measured = 1;
  context_.bus.publish("PITCH_STATE", message);
}

nlohmann::json LevelScannerNode::metrics() const {
  return {{"scans", seq_}};
}

}  // namespace nodmap::trial
