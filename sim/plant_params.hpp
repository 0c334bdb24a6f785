// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/angle.hpp"

namespace nodmap::sim {

/// KURT3D as built: body (paper, II), scanner, wheels. Where a figure is not from a source, its
/// reason is in sim/README.md.
struct PlantParams {
  double body_length_m = 0.45;
  double body_width_m = 0.33;
  double body_height_m = 0.47;  // with the scanner
  double mass_kg = 22.6;        // with the scanner
  double climb_height_m = 0.03;
  double max_slope_rad = geometry::deg_to_rad(15.0);
  double tilt_per_mps2_rad = geometry::deg_to_rad(0.1);

  double mount_x_m = 0.15;  // of the pitch axis on the base, as drivers/laser3d assumes by default
  double mount_z_m = 0.38;

  double motor_power_w = 90.0;
  double motor_lag_s = 0.05;
  double grip = 0.6;
  double top_speed_mps = 5.2;
  double axis_m = 0.28;
  double turning_adaptation = 0.69;
  double odometry_scale_bias = 0.0;
  double slip_distance_m = 0.01;
  double slip_heading_rad = geometry::deg_to_rad(0.5);
  double slip_turn_rad = geometry::deg_to_rad(2.0);

  double pitch_limit_rad = geometry::deg_to_rad(65.0);
  double servo_speed_rad_s = 3.5;
  double servo_acceleration_rad_s2 = 50.0;

  double spot_diameter_m = 0.010;
  double divergence_rad = geometry::deg_to_rad(0.25);
  double range_sigma_m = 0.01;
  double range_bias_m = 0.0;
  double laser_reach_m = 80.0;
  double pulse_length_m = 1.5;
  double least_intensity = 8e-4;
  double dazzle_angle_rad = geometry::deg_to_rad(15.0);

  template <class Visitor>
  void describe(Visitor& v) {
    describe_body(v);
    describe_wheels(v);
    describe_servo(v);
    describe_laser(v);
  }

 private:
  template <class Visitor>
  void describe_body(Visitor& v) {
    v.number("body_length_m", body_length_m, {0.05, 5.0}, "Length of the robot's body.");
    v.number("body_width_m", body_width_m, {0.05, 5.0}, "Width of the robot's body.");
    v.number("body_height_m", body_height_m, {0.05, 5.0}, "Height of the robot with its scanner.");
    v.number("mass_kg", mass_kg, {1.0, 1000.0}, "Mass of the robot with its scanner.");
    v.number("climb_height_m", climb_height_m, {0.0, 0.2},
             "Lower things are driven over; deeper drops are falls.");
    v.angle("max_slope_deg", max_slope_rad, {0.0, 45.0}, "Steeper ramps are obstacles.");
    v.angle("tilt_per_mps2_deg", tilt_per_mps2_rad, {0.0, 5.0},
            "How far the body leans back when it gains 1 m/s in a second.");
    v.number("mount_x_m", mount_x_m, {-2.0, 2.0}, "Pitch axis ahead of the base's origin.");
    v.number("mount_z_m", mount_z_m, {0.0, 3.0}, "Pitch axis above the ground.");
  }

  template <class Visitor>
  void describe_wheels(Visitor& v) {
    v.number("motor_power_w", motor_power_w, {1.0, 10000.0}, "Power of each of the two motors.");
    v.number("motor_lag_s", motor_lag_s, {0.002, 5.0},
             "Time constant with which the motors' controllers follow a speed.");
    v.number("grip", grip, {0.05, 2.0}, "Friction of the wheels on the ground.");
    v.number("top_speed_mps", top_speed_mps, {0.1, 5.2}, "Speed that is never exceeded.");
    v.number("axis_m", axis_m, {0.05, 5.0}, "Distance of left and right wheels.");
    v.number("turning_adaptation", turning_adaptation, {0.1, 2.0},
             "Share of the wheels' turn that skidding leaves to the robot.");
    v.number("odometry_scale_bias", odometry_scale_bias, {-0.5, 0.5},
             "By which share more way the wheels count than the robot goes.");
    v.number(
        "slip_distance_m", slip_distance_m, {0.0, 1.0},
        "Standard deviation of the way that slip adds in 1 m; grows with the root of the way.");
    v.angle("slip_heading_deg", slip_heading_rad, {0.0, 45.0},
            "Standard deviation of the turn that slip adds in 1 m of way.");
    v.angle("slip_turn_deg", slip_turn_rad, {0.0, 45.0},
            "Standard deviation of the turn that slip adds in turning by 1 rad.");
  }

  template <class Visitor>
  void describe_servo(Visitor& v) {
    v.angle("pitch_limit_deg", pitch_limit_rad, {1.0, 90.0},
            "How far the head can look up or down.");
    v.number("servo_speed_rad_s", servo_speed_rad_s, {0.01, 100.0},
             "Fastest pitch rate with the head's weight.");
    v.number("servo_acceleration_rad_s2", servo_acceleration_rad_s2, {0.1, 10000.0},
             "Greatest acceleration of the head.");
  }

  template <class Visitor>
  void describe_laser(Visitor& v) {
    v.number("spot_diameter_m", spot_diameter_m, {0.0, 0.1},
             "Diameter of the laser's spot at the mirror.");
    v.angle("divergence_deg", divergence_rad, {0.0, 5.0}, "Full angle by which the beam widens.");
    v.number("range_sigma_m", range_sigma_m, {0.0, 1.0}, "Standard deviation of a range.");
    v.number("range_bias_m", range_bias_m, {-1.0, 1.0}, "Added to each range.");
    v.number("laser_reach_m", laser_reach_m, {0.1, 200.0}, "Nothing beyond is seen.");
    v.number("pulse_length_m", pulse_length_m, {0.0, 100.0},
             "Surfaces in one beam that are closer together give one range in between.");
    v.number("least_intensity", least_intensity, {0.0, 1.0},
             "Echoes with less of the light that a white surface sends back at 1 m are not seen.");
    v.angle("dazzle_angle_deg", dazzle_angle_rad, {0.0, 90.0},
            "A reflector (reflectivity beyond 1) sends its surplus back up to this incidence.");
  }
};

}  // namespace nodmap::sim
