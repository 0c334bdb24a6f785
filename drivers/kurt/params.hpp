// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {

/// What the KURT2 can do; no configuration goes beyond.
inline constexpr double kTopSpeedMps = 5.2;

/// How a turn rate becomes wheel speeds.
enum class Steering : std::uint8_t {
  kCalibrated,  ///< so that odometry measures the turn rate that was asked for
  kKurtDriver,  ///< v -+ axis * turn rate, as uos/kurt_driver does
};

/// The defaults are those of the indoor KURT2.
struct KurtParams {
  std::string device;
  int baud = 1'000'000;

  double wheel_perimeter_m = 0.379;
  double axis_m = 0.28;
  double turning_adaptation = 0.69;
  int ticks_per_turn = 21950;
  Steering steering = Steering::kCalibrated;

  double distance_sigma_m = 0.02;
  double heading_sigma_rad = geometry::deg_to_rad(1.0);
  double turn_sigma_rad = geometry::deg_to_rad(5.0);

  double max_speed_mps = kTopSpeedMps;
  double max_acceleration_mps2 = 1.5;
  double max_deceleration_mps2 = 3.0;
  double drive_timeout_s = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.text("device", device,
           "Serial port of the CAN adapter, best as /dev/serial/by-id/...; must be given.");
    v.integer("baud", baud, {9600, 3'000'000},
              "Rate of the serial line, bit/s; 1000000 for the Lawicel CANUSB.");
    v.number("wheel_perimeter_m", wheel_perimeter_m, {0.1, 2.0},
             "Way of one turn of a wheel; outdoor KURT2 0.518.");
    v.number("axis_m", axis_m, {0.1, 1.0}, "Distance of left and right wheels; outdoor 0.39.");
    v.number("turning_adaptation", turning_adaptation, {0.1, 2.0},
             "Share of the wheels' turn that skidding leaves to the robot; outdoor 0.64.");
    v.integer("ticks_per_turn", ticks_per_turn, {1, 1'000'000},
              "Encoder ticks of one turn of a wheel; kurt_fast 5120.");
    v.choice(
        "steering", steering,
        {{"calibrated", Steering::kCalibrated}, {"kurt_driver", Steering::kKurtDriver}},
        "How a turn rate becomes wheel speeds: so that odometry measures it, or as kurt_driver.");
    v.number(
        "distance_sigma_m", distance_sigma_m, {0.0, 1.0},
        "Standard deviation of the position after driving 1 m; grows with the root of the way.");
    v.angle("heading_sigma_deg", heading_sigma_rad, {0.0, 45.0},
            "Standard deviation of the heading after driving 1 m.");
    v.angle("turn_sigma_deg", turn_sigma_rad, {0.0, 45.0},
            "Standard deviation of the heading after turning by 1 rad.");
    v.number("max_speed_mps", max_speed_mps, {0.05, kTopSpeedMps},
             "Fastest speed of a wheel; faster commands keep their curvature.");
    v.number("max_acceleration_mps2", max_acceleration_mps2, {0.1, 10.0},
             "Fastest gain of speed of a wheel.");
    v.number("max_deceleration_mps2", max_deceleration_mps2, {0.1, 20.0},
             "Fastest loss of speed of a wheel on command; a stop for safety has no limit.");
    v.number("drive_timeout_s", drive_timeout_s, {0.02, 0.2},
             "The robot stops when no DRIVE has come for so long.");
  }
};

}  // namespace nodmap::kurt
