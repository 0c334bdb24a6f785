// SPDX-License-Identifier: BSD-3-Clause
// KURT3D as built: body (paper, section II), drive, pitch servo, laser. The sources and reasons of
// the values are in sim/README.md. The simulator has its own copy of the robot's dimensions, so
// that a wrong value in the robot's software is noticed.
#pragma once

#include "common/geometry/angle.hpp"

namespace nodmap::sim {

/// The body, and the obstacles that it can drive over.
struct BodyParams {
  double length_m = 0.45;
  double width_m = 0.33;
  double height_m = 0.47;     // with the scanner
  double wheelbase_m = 0.30;  // three wheels of 12 cm in a row, within the body's length
  double climb_height_m = 0.03;
  double max_slope_rad = geometry::deg_to_rad(15.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("body_length_m", length_m, {0.05, 5.0}, "Length of the robot's body.");
    v.number("body_width_m", width_m, {0.05, 5.0}, "Width of the robot's body.");
    v.number("body_height_m", height_m, {0.05, 5.0}, "Height of the robot with its scanner.");
    v.number("wheelbase_m", wheelbase_m, {0.05, 5.0},
             "Distance from the front to the rear wheels, on which the body rests.");
    v.number("climb_height_m", climb_height_m, {0.0, 0.2},
             "Height of obstacles that the robot can drive over; deeper drops are falls.");
    v.angle("max_slope_deg", max_slope_rad, {0.0, 45.0}, "Steepest ramp that is not an obstacle.");
  }
};

/// Motors, wheels and the ground under them.
struct DriveParams {
  double mass_kg = 22.6;  // with the scanner
  double motor_power_w = 90.0;
  double motor_lag_s = 0.05;
  double friction = 0.6;
  double top_speed_mps = 5.2;
  double axis_length_m = 0.28;
  double turning_adaptation = 0.69;
  double odometry_scale_bias = 0.0;
  double odometry_scale_difference = 0.0;
  double slip_distance_m = 0.01;
  double slip_heading_rad = geometry::deg_to_rad(1.0);
  double slip_turning_rad = geometry::deg_to_rad(2.0);
  double tilt_per_mps2_rad = geometry::deg_to_rad(0.1);
  double ground_tilt_rad = geometry::deg_to_rad(0.1);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("mass_kg", mass_kg, {1.0, 1000.0}, "Mass of the robot with its scanner.");
    v.number("motor_power_w", motor_power_w, {1.0, 10000.0}, "Power of each of the two motors.");
    v.number("motor_lag_s", motor_lag_s, {0.002, 5.0},
             "Time constant of the motors' speed controllers.");
    v.number("friction", friction, {0.05, 2.0},
             "Friction coefficient of the wheels on the ground.");
    v.number("top_speed_mps", top_speed_mps, {0.1, 5.2}, "Speed that is never exceeded.");
    v.number("axis_length_m", axis_length_m, {0.05, 5.0},
             "Distance between the left and the right wheels.");
    v.number("turning_adaptation", turning_adaptation, {0.1, 2.0},
             "True rotation divided by the rotation that the wheels' speeds alone would give.");
    v.number("odometry_scale_bias", odometry_scale_bias, {-0.5, 0.5},
             "Relative excess of the distance counted by each wheel over the true distance; also "
             "affects rotations.");
    v.number(
        "odometry_scale_difference", odometry_scale_difference, {-0.1, 0.1},
        "Difference of this excess between left and right wheels, as caused by unequal diameters.");
    v.number("slip_distance_m", slip_distance_m, {0.0, 1.0},
             "Standard deviation of the distance error by slip over a long drive, divided by the "
             "root of its length in m; after 1 m a tenth smaller.");
    v.angle("slip_heading_deg", slip_heading_rad, {0.0, 45.0}, "The same of the heading error.");
    v.angle("slip_turning_deg", slip_turning_rad, {0.0, 45.0},
            "Standard deviation of the heading error by slip in a long rotation on the spot, "
            "divided by the root of the rotation in rad; after 1 rad two fifths smaller.");
    v.angle("tilt_per_mps2_deg", tilt_per_mps2_rad, {0.0, 5.0},
            "Tilt of the body on its tyres per 1 m/s^2 of acceleration.");
    v.angle("ground_tilt_deg", ground_tilt_rad, {0.0, 5.0},
            "Standard deviation of the body's roll and pitch on uneven ground.");
  }
};

/// The pitch axis on the base, the laser on its head, and the servo that moves it.
struct ServoParams {
  double mount_x_m = 0.15;
  double mount_z_m = 0.38;
  double mirror_forward_m = 0.0;
  double mirror_up_m = 0.0;
  double laser_roll_rad = 0.0;
  double laser_yaw_rad = 0.0;
  double pitch_limit_rad = geometry::deg_to_rad(65.0);
  double speed_rad_s = 3.5;
  double acceleration_rad_s2 = 50.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("mount_x_m", mount_x_m, {-2.0, 2.0},
             "Distance of the pitch axis ahead of the base's origin.");
    v.number("mount_z_m", mount_z_m, {0.0, 3.0}, "Height of the pitch axis above the ground.");
    v.number("mirror_forward_m", mirror_forward_m, {-0.5, 0.5},
             "Distance of the laser's mirror ahead of the pitch axis, at pitch 0.");
    v.number("mirror_up_m", mirror_up_m, {-0.5, 0.5},
             "Height of the laser's mirror above the pitch axis, at pitch 0.");
    v.angle("laser_roll_deg", laser_roll_rad, {-10.0, 10.0},
            "Roll of the laser on its head, positive to the right; the drivers assume none.");
    v.angle("laser_yaw_deg", laser_yaw_rad, {-10.0, 10.0},
            "Yaw of the laser on its head, positive to the left; the drivers assume none.");
    v.angle("pitch_limit_deg", pitch_limit_rad, {1.0, 90.0},
            "Largest pitch of the laser, up and down.");
    v.number("servo_speed_rad_s", speed_rad_s, {0.01, 100.0},
             "Largest pitch rate with the laser's weight.");
    v.number("servo_acceleration_rad_s2", acceleration_rad_s2, {0.1, 10000.0},
             "Largest pitch acceleration.");
  }
};

/// The optics of the SICK LMS200.
struct LaserParams {
  double spot_diameter_m = 0.010;
  double divergence_rad = geometry::deg_to_rad(0.25);
  double range_sigma_m = 0.01;
  double range_bias_m = 0.0;
  double max_range_m = 80.0;
  double pulse_length_m = 1.5;
  double min_intensity = 8e-4;
  double dazzle_angle_rad = geometry::deg_to_rad(15.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("spot_diameter_m", spot_diameter_m, {0.0, 0.1},
             "Diameter of the laser's spot at the mirror.");
    v.angle("divergence_deg", divergence_rad, {0.0, 5.0}, "Full opening angle of the beam.");
    v.number("range_sigma_m", range_sigma_m, {0.0, 1.0}, "Standard deviation of a range.");
    v.number("range_bias_m", range_bias_m, {-1.0, 1.0}, "Systematic error, added to each range.");
    v.number("max_range_m", max_range_m, {0.1, 200.0}, "Longest range that the laser measures.");
    v.number("pulse_length_m", pulse_length_m, {0.0, 100.0},
             "Distance up to which two surfaces in one beam give a single range between them.");
    v.number("min_intensity", min_intensity, {0.0, 1.0},
             "Weakest echo that is detected, relative to a white surface at 1 m.");
    v.angle("dazzle_angle_deg", dazzle_angle_rad, {0.0, 90.0},
            "Largest angle of incidence at which a reflector (reflectivity > 1) dazzles.");
  }
};

/// The parameters of the simulated robot without the electronics of its devices.
struct RobotModelParams {
  BodyParams body;
  DriveParams drive;
  ServoParams servo;
  LaserParams laser;

  template <class Visitor>
  void describe(Visitor& v) {
    body.describe(v);
    drive.describe(v);
    servo.describe(v);
    laser.describe(v);
  }
};

}  // namespace nodmap::sim
