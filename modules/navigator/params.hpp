// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/angle.hpp"
#include "common/robot/robot_params.hpp"

namespace nodmap::navigator {

struct NavigatorParams {
  robot::RobotParams robot;
  double side_margin_m = 0.06;
  double turn_margin_m = 0.04;

  double max_forward_mps = 1.5;
  double max_yaw_rate_rad_s = geometry::deg_to_rad(80.0);
  double max_lateral_mps2 = 0.8;
  double reaction_s = 0.1;

  double open_space_m = 1.0;
  double chord_m = 0.8;
  double view_half_rad = geometry::deg_to_rad(70.0);
  int half_sweeps_to_trust = 2;

  double turn_rate_rad_s = geometry::deg_to_rad(60.0);
  double turn_until_free_m = 0.6;
  double retry_s = 5.0;
  double back_up_mps = 0.1;
  double back_up_m = 2.0;

  double map_stale_s = 0.1;
  double odometry_stale_s = 0.1;
  double pitch_command_stale_s = 0.15;
  double pitch_state_stale_s = 0.15;
  double drive_valid_s = 0.15;

  template <class Visitor>
  void describe(Visitor& v) {
    robot.describe(v);
    v.number("side_margin_m", side_margin_m, {0.0, 0.5},
             "Room to be kept on each side: with the body's width, the virtual corridor.");
    v.number("turn_margin_m", turn_margin_m, {0.0, 0.5},
             "Room to be kept around the body when turning on the spot.");
    v.number("max_forward_mps", max_forward_mps, {0.05, 5.2},
             "Fastest forward speed, however free the way is.");
    v.angle("max_yaw_rate_deg_s", max_yaw_rate_rad_s, {5.0, 180.0},
            "Fastest turn rate while driving.");
    v.number("max_lateral_mps2", max_lateral_mps2, {0.1, 5.0},
             "Largest lateral acceleration: forward speed times turn rate.");
    v.number("reaction_s", reaction_s, {0.02, 1.0},
             "From the middle of a scan until the robot slows down.");
    v.number("open_space_m", open_space_m, {0.3, 5.0},
             "Free way that counts half in the free-space orientation, and is enough to steer to.");
    v.number("chord_m", chord_m, {0.3, 5.0},
             "The arc it drives leads to the steering direction at this distance.");
    v.angle("view_half_deg", view_half_rad, {10.0, 89.0},
            "Directions up to so far from ahead are in the laser's view, also close to the robot.");
    v.integer("half_sweeps_to_trust", half_sweeps_to_trust, {1, 10},
              "Turns of the nod a direction must have been in view before the robot drives there.");
    v.angle("turn_rate_deg_s", turn_rate_rad_s, {5.0, 180.0}, "Turn rate on the spot.");
    v.number("turn_until_free_m", turn_until_free_m, {0.2, 5.0},
             "Turn ends where the way ahead is free for so far.");
    v.number("retry_s", retry_s, {0.5, 60.0}, "Pause after a whole turn without a free direction.");
    v.number("back_up_mps", back_up_mps, {0.02, 0.3},
             "Speed back along its own trail where it cannot turn.");
    v.number("back_up_m", back_up_m, {0.05, 4.0}, "Longest way back in one go.");
    v.number("map_stale_s", map_stale_s, {0.03, 0.25},
             "The robot halts when the obstacle map is older.");
    v.number("odometry_stale_s", odometry_stale_s, {0.03, 0.25},
             "The robot halts when odometry is older than the map by more.");
    v.number("pitch_command_stale_s", pitch_command_stale_s, {0.03, 0.25},
             "The robot halts when the pitch controller's speed bound is older.");
    v.number("pitch_state_stale_s", pitch_state_stale_s, {0.03, 0.25},
             "The robot halts when the reading of the pitch servo is older.");
    v.number("drive_valid_s", drive_valid_s, {0.05, 0.2}, "How long a DRIVE may be obeyed.");
  }
};

}  // namespace nodmap::navigator
