// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/geometry/angle.hpp"
#include "common/robot/robot_params.hpp"
#include "drivers/laser3d/sick_command.hpp"

namespace nodmap::laser3d {

enum class ServoKind : std::uint8_t { kDynamixel, kMaestro };

/// The measuring modes that are ranges without fields, in the words of a user.
enum class LaserReach : std::uint8_t { k8m, k16m, k32m };

struct Laser3dParams {
  std::string laser_device = "/dev/scanner";
  int laser_baud = 500000;
  SickVariant variant = SickVariant::k180x100;
  bool interlaced = false;
  SickUnit unit = SickUnit::kMillimetre;
  LaserReach reach = LaserReach::k32m;
  double range_min_m = 0.05;
  double range_max_m = 30.0;
  bool upside_down = false;
  double laser_time_offset_s = 0.0;
  int frozen_scans = 3;

  ServoKind servo = ServoKind::kDynamixel;
  std::string servo_device = "/dev/servo";
  int servo_baud = 1'000'000;
  int servo_id = 1;
  int servo_level_position = 2048;
  bool servo_inverted = false;
  double servo_poll_hz = 200.0;
  double maestro_level_us = 1545.0;
  double maestro_us_per_deg = -9.09;

  robot::RobotParams robot;
  double default_min_rad = geometry::deg_to_rad(-40.0);
  double default_max_rad = geometry::deg_to_rad(15.0);
  double default_sweep_s = 0.8;
  double command_timeout_s = 1.0;

  double mirror_forward_m = 0.0;
  double mirror_up_m = 0.0;
  double max_extrapolation_s = 0.010;

  template <class Visitor>
  void describe(Visitor& v) {
    describe_laser(v);
    describe_servo(v);
    describe_movement(v);
    describe_mirror(v);
  }

 private:
  template <class Visitor>
  void describe_laser(Visitor& v) {
    v.text("laser_device", laser_device, "Serial line of the SICK LMS2xx.");
    v.choice("laser_baud", laser_baud,
             {{"9600", 9600}, {"19200", 19200}, {"38400", 38400}, {"500000", 500000}},
             "Rate to stream at; only 500000 (RS-422) loses no scan.");
    v.choice("variant", variant,
             {{"180x1", SickVariant::k180x100},
              {"180x0.5", SickVariant::k180x050},
              {"100x1", SickVariant::k100x100},
              {"100x0.5", SickVariant::k100x050},
              {"100x0.25", SickVariant::k100x025}},
             "Field of view and resolution, degrees.");
    v.flag(
        "interlaced", interlaced,
        "Stream each turn of the mirror at once, shifted in turn by the resolution; 180 degrees.");
    v.choice("unit", unit, {{"mm", SickUnit::kMillimetre}, {"cm", SickUnit::kCentimetre}},
             "Unit of the readings on the line; cm reaches 80 m.");
    v.choice("reach", reach,
             {{"8m", LaserReach::k8m}, {"16m", LaserReach::k16m}, {"32m", LaserReach::k32m}},
             "How far a reading in mm can tell; ten times as far in cm, at most 80 m.");
    v.number("range_min_m", range_min_m, {0.0, 5.0},
             "Readings below are the housing or the robot.");
    v.number("range_max_m", range_max_m, {1.0, 80.0}, "How far readings are trusted.");
    v.flag("upside_down", upside_down, "The laser hangs head down: its left is the robot's right.");
    v.number("laser_time_offset_s", laser_time_offset_s, {-0.1, 0.1},
             "Added to the time of every beam: what is constant and cannot be seen from here.");
    v.integer(
        "frozen_scans", frozen_scans, {2, 1000},
        "So many repetitions in a row of one scan are no measurement any more. With its noise "
        "a laser repeats ten readings to the millimetre less than once in 1e12 scans.");
  }

  template <class Visitor>
  void describe_servo(Visitor& v) {
    v.choice("servo", servo,
             {{"dynamixel", ServoKind::kDynamixel}, {"maestro", ServoKind::kMaestro}},
             "Pitch servo: Dynamixel X (measured pitch) or Pololu Maestro (open loop).");
    v.text("servo_device", servo_device, "Serial line of the servo.");
    v.integer("servo_baud", servo_baud, {9600, 4'500'000}, "Rate of that line, bit/s.");
    v.integer("servo_id", servo_id, {0, 252}, "Dynamixel id, or Maestro channel.");
    v.integer("servo_level_position", servo_level_position, {0, 4095},
              "Dynamixel position at which the laser looks straight ahead.");
    v.flag("servo_inverted", servo_inverted, "Larger Dynamixel positions look down.");
    v.number("servo_poll_hz", servo_poll_hz, {20.0, 500.0}, "How often the pitch is read.");
    v.number("maestro_level_us", maestro_level_us, {500.0, 2500.0},
             "Pulse at which the laser looks straight ahead.");
    v.number("maestro_us_per_deg", maestro_us_per_deg, {-50.0, 50.0},
             "Change of the pulse for a degree up.");
  }

  template <class Visitor>
  void describe_movement(Visitor& v) {
    robot.describe(v);
    v.angle("default_min_deg", default_min_rad, {-90.0, 90.0},
            "Lower end of the sweep while nobody commands.");
    v.angle("default_max_deg", default_max_rad, {-90.0, 90.0},
            "Upper end of the sweep while nobody commands; equal to the lower: held there.");
    v.number("default_sweep_s", default_sweep_s, {0.1, 60.0},
             "Time from one end to the other while nobody commands.");
    v.number("command_timeout_s", command_timeout_s, {0.1, 10.0},
             "A PITCH_COMMAND older than this counts no more.");
  }

  template <class Visitor>
  void describe_mirror(Visitor& v) {
    v.number("mirror_forward_m", mirror_forward_m, {-0.5, 0.5},
             "Mirror's centre ahead of the pitch axis, at pitch 0.");
    v.number("mirror_up_m", mirror_up_m, {-0.5, 0.5},
             "Mirror's centre above the pitch axis, at pitch 0.");
    v.number("max_extrapolation_s", max_extrapolation_s, {0.0, 0.1},
             "How far beyond the newest servo reading a pitch is still told.");
  }
};

}  // namespace nodmap::laser3d
