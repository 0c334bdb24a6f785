// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {

/// Top speed of the KURT2; no configuration can exceed it.
inline constexpr double kTopSpeedMps = 5.2;

/// How a yaw rate is converted to wheel speeds.
enum class Steering : std::uint8_t {
  kCalibrated,  ///< so that odometry measures the commanded yaw rate
  kKurtDriver,  ///< v -+ axis * yaw rate, as uos/kurt_driver does
};

/// The wheels and how they move the robot. The defaults are for the indoor KURT2.
struct WheelParams {
  double perimeter_m = 0.379;
  double axis_m = 0.28;
  double turning_adaptation = 0.69;
  int ticks_per_revolution = 21950;
  Steering steering = Steering::kCalibrated;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("perimeter_m", perimeter_m, {0.1, 2.0},
             "Distance covered by one revolution of a wheel; outdoor KURT2 0.518.");
    v.number("axis_m", axis_m, {0.1, 1.0}, "Distance between left and right wheels; outdoor 0.39.");
    v.number("turning_adaptation", turning_adaptation, {0.1, 2.0},
             "Ratio of the robot's rotation to the rotation that its wheels would give without "
             "slip; outdoor 0.64.");
    v.integer("ticks_per_revolution", ticks_per_revolution, {1, 1'000'000},
              "Encoder ticks per revolution of a wheel; kurt_fast 5120.");
    v.choice("steering", steering,
             {{"calibrated", Steering::kCalibrated}, {"kurt_driver", Steering::kKurtDriver}},
             "Conversion of a yaw rate to wheel speeds: calibrated, so that odometry measures the "
             "commanded rate, or as kurt_driver does it.");
  }
};

/// The uncertainty of odometry. Variances grow in proportion to distance and rotation.
struct OdometryNoiseParams {
  double distance_sigma_m = 0.02;
  double heading_sigma_rad = geometry::deg_to_rad(1.0);
  double rotation_sigma_rad = geometry::deg_to_rad(5.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("distance_sigma_m", distance_sigma_m, {0.0, 1.0},
             "Standard deviation of the position after driving 1 m; grows with the root of the "
             "distance.");
    v.angle("heading_sigma_deg", heading_sigma_rad, {0.0, 45.0},
            "Standard deviation of the heading after driving 1 m.");
    v.angle("rotation_sigma_deg", rotation_sigma_rad, {0.0, 45.0},
            "Standard deviation of the heading after rotating by 1 rad.");
  }
};

/// How the gyro corrects the heading of odometry. The defaults are those of a MEMS gyro.
struct GyroParams {
  bool use_gyro = true;
  double scale = 1.0;
  double noise_rad = geometry::deg_to_rad(0.07);
  double scale_sigma = 0.005;
  double bias_walk_rad_s = geometry::deg_to_rad(0.003);
  double max_bias_rad_s = geometry::deg_to_rad(3.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("use_gyro", use_gyro,
           "Correct the heading of odometry by the gyro, once its bias has been measured.");
    v.number("scale", scale, {-2.0, 2.0},
             "Rotation of the robot divided by that of the gyro's angle; negative for a gyro that "
             "turns the other way round.");
    v.angle("noise_deg", noise_rad, {0.001, 10.0},
            "Standard deviation of the gyro's angle after 1 s; grows with the root of the time.");
    v.number("scale_sigma", scale_sigma, {0.0, 0.2},
             "Standard deviation of the relative error of its rotations.");
    v.angle("bias_walk_deg_s", bias_walk_rad_s, {0.0, 1.0},
            "Standard deviation of the change of its bias in 1 s; grows with the root of the "
            "time.");
    v.angle("max_bias_deg_s", max_bias_rad_s, {0.0, 60.0},
            "Bias beyond which the gyro is not used.");
  }
};

/// Limits of the wheels' speed and of its change.
struct SpeedLimits {
  double max_speed_mps = kTopSpeedMps;
  double max_acceleration_mps2 = 1.5;
  double max_deceleration_mps2 = 3.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("max_speed_mps", max_speed_mps, {0.05, kTopSpeedMps},
             "Greatest speed of a wheel; faster commands are scaled and keep their curvature.");
    v.number("max_acceleration_mps2", max_acceleration_mps2, {0.1, 10.0},
             "Greatest acceleration of a wheel.");
    v.number("max_deceleration_mps2", max_deceleration_mps2, {0.1, 20.0},
             "Greatest deceleration of a wheel on command; a safety stop is not limited.");
  }
};

/// When the base's own sensors slow or stop the robot.
struct GuardParams {
  bool use_ranges = true;
  double near_m = 0.25;
  double creep_mps = 0.1;
  bool use_bumper = true;
  double max_tilt_rad = geometry::deg_to_rad(25.0);
  double stall_s = 2.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag(
        "use_ranges", use_ranges,
        "Slow down before obstacles that the sonar or the infrared range finders detect ahead or "
        "behind.");
    v.number("near_m", near_m, {0.23, 1.0},
             "Distance to such an obstacle below which the robot creeps; the sonar cannot measure "
             "less than 0.23 m.");
    v.number(
        "creep_mps", creep_mps, {0.0, 1.0},
        "Greatest speed nearer than near_m to such an obstacle, and while a bumper is touched or "
        "the base is tilted.");
    v.flag("use_bumper", use_bumper, "Stop when a bumper is touched.");
    v.angle("max_tilt_deg", max_tilt_rad, {5.0, 90.0},
            "Stop when the base is tilted by more than this for half a second: it is falling or "
            "being carried.");
    v.number("stall_s", stall_s, {0.1, 60.0},
             "Stop when a wheel should turn and does not for this long.");
  }
};

struct KurtParams {
  std::string device;
  int baud = 1'000'000;
  WheelParams wheels;
  OdometryNoiseParams odometry;
  GyroParams gyro;
  SpeedLimits limits;
  GuardParams guard;
  double drive_timeout_s = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.text("device", device,
           "Serial port of the CAN adapter, preferably /dev/serial/by-id/...; required.");
    // A slower line cannot carry what base and driver send, so commands would wait in it for
    // seconds.
    v.integer("baud", baud, {57'600, 3'000'000},
              "Rate of the serial line, bit/s; 1000000 for the Lawicel CANUSB.");
    v.section("wheels", wheels);
    v.section("odometry", odometry);
    v.section("gyro", gyro);
    v.section("limits", limits);
    v.section("guard", guard);
    v.number("drive_timeout_s", drive_timeout_s, {0.02, 0.2},
             "The robot stops when it has received no DRIVE for this long.");
    describe_renamed(v);
  }

 private:
  template <class Visitor>
  static void describe_renamed(Visitor& v) {
    v.renamed("wheel_perimeter_m", "wheels.perimeter_m");
    v.renamed("ticks_per_turn", "wheels.ticks_per_revolution");
    v.renamed("turn_sigma_deg", "odometry.rotation_sigma_deg");
    for (const char* key : {"axis_m", "turning_adaptation", "steering"}) {
      v.renamed(key, std::string("wheels.") + key);
    }
    for (const char* key : {"distance_sigma_m", "heading_sigma_deg"}) {
      v.renamed(key, std::string("odometry.") + key);
    }
    for (const char* key : {"max_speed_mps", "max_acceleration_mps2", "max_deceleration_mps2"}) {
      v.renamed(key, std::string("limits.") + key);
    }
  }
};

/// Checks that the parameters name a device. Throws params::ParamError.
void check(const KurtParams& params);

}  // namespace nodmap::kurt
