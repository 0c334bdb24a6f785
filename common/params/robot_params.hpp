// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/angle.hpp"

namespace nodmap::params {

/// The robot as built: body and nodding head of KURT3D (paper, II). Driver, maps, pitch controller
/// and navigator must agree on it, so each of them takes all of it, used or not, and one file says
/// it to all. Base frame: origin on the floor between the wheels.
struct RobotParams {
  double length_m = 0.45;
  double width_m = 0.33;
  double height_m = 0.47;  // with its scanner

  double mount_x_m = 0.15;
  double mount_y_m = 0.0;
  double mount_z_m = 0.38;

  double pitch_min_rad = geometry::deg_to_rad(-60.0);
  double pitch_max_rad = geometry::deg_to_rad(60.0);
  double pitch_rate_rad_s = 3.0;
  double pitch_acceleration_rad_s2 = 40.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("robot_length_m", length_m, {0.05, 5.0}, "Length of the robot's body.");
    v.number("robot_width_m", width_m, {0.05, 5.0}, "Width of the robot's body.");
    v.number("robot_height_m", height_m, {0.25, 5.0},
             "Height of the robot with its scanner: the top of the virtual corridor.");
    v.number("mount_x_m", mount_x_m, {-2.0, 2.0}, "Pitch axis on the base, forward.");
    v.number("mount_y_m", mount_y_m, {-2.0, 2.0}, "Pitch axis on the base, to the left.");
    v.number("mount_z_m", mount_z_m, {0.1, 3.0}, "Pitch axis above the floor.");
    v.angle("pitch_min_deg", pitch_min_rad, {-85.0, -5.0}, "Lowest pitch the mechanics allow.");
    v.angle("pitch_max_deg", pitch_max_rad, {5.0, 85.0}, "Highest pitch the mechanics allow.");
    v.number("pitch_rate_rad_s", pitch_rate_rad_s, {0.05, 10.0}, "Fastest pitch rate of the head.");
    v.number("pitch_acceleration_rad_s2", pitch_acceleration_rad_s2, {0.4, 1000.0},
             "Of the head at the ends of a sweep.");
  }
};

}  // namespace nodmap::params
