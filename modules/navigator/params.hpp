// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/angle.hpp"
#include "common/robot/robot_params.hpp"

namespace nodmap::navigator {

/// Limits of driving, and the width of the virtual corridor.
struct DriveParams {
  double side_margin_m = 0.06;
  double max_forward_mps = 1.5;
  double max_yaw_rate_rad_s = geometry::deg_to_rad(80.0);
  double max_lateral_mps2 = 0.8;
  double reaction_s = 0.1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("side_margin_m", side_margin_m, {0.0, 0.5},
             "Margin on each side of the body: with its width, the virtual corridor.");
    v.number("max_forward_mps", max_forward_mps, {0.05, 5.2},
             "Fastest forward speed, however long the free distance is.");
    v.angle("max_yaw_rate_deg_s", max_yaw_rate_rad_s, {5.0, 180.0},
            "Fastest yaw rate while driving.");
    v.number("max_lateral_mps2", max_lateral_mps2, {0.1, 5.0},
             "Largest lateral acceleration: forward speed times yaw rate.");
    v.number("reaction_s", reaction_s, {0.02, 1.0},
             "From the middle of a scan until the robot slows down.");
  }
};

struct SteerParams {
  double open_space_m = 1.0;
  double chord_m = 0.8;
  double view_half_rad = geometry::deg_to_rad(70.0);
  int sweeps_to_trust = 2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("open_space_m", open_space_m, {0.3, 5.0},
             "Free distance that counts half in the free-space orientation, and is enough to steer "
             "to.");
    v.number("chord_m", chord_m, {0.3, 5.0},
             "Length of the chord of the arc that leads to the steering direction.");
    v.angle("view_half_deg", view_half_rad, {10.0, 89.0},
            "Directions up to so far from ahead are in the laser's view, also close to the robot.");
    v.integer("sweeps_to_trust", sweeps_to_trust, {1, 10},
              "Sweeps during which a direction must have been in view before the robot drives "
              "there.");
  }
};

struct TurnParams {
  double margin_m = 0.04;
  double rate_rad_s = geometry::deg_to_rad(60.0);
  double until_free_m = 0.6;
  double retry_s = 5.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("turn_margin_m", margin_m, {0.0, 0.5},
             "Margin around the body when it turns on the spot.");
    v.angle("turn_rate_deg_s", rate_rad_s, {5.0, 180.0}, "Yaw rate on the spot.");
    v.number("turn_until_free_m", until_free_m, {0.2, 5.0},
             "Turn ends where the free distance ahead is this long.");
    v.number("retry_s", retry_s, {0.5, 60.0},
             "Pause after a full rotation without a free direction.");
  }
};

struct BackUpParams {
  double speed_mps = 0.1;
  double distance_m = 2.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("back_up_mps", speed_mps, {0.02, 0.3},
             "Speed at which it backs up along its trail where it cannot turn.");
    v.number("back_up_m", distance_m, {0.05, 4.0}, "Longest distance to back up at once.");
  }
};

/// The ages from which on an input is stale.
struct StalenessParams {
  double map_s = 0.1;
  double odometry_s = 0.1;
  double pitch_command_s = 0.15;
  double pitch_state_s = 0.15;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("map_stale_s", map_s, {0.03, 0.25}, "The robot halts when the obstacle map is older.");
    v.number("odometry_stale_s", odometry_s, {0.03, 0.25},
             "The robot halts when odometry is older than the map by more.");
    v.number("pitch_command_stale_s", pitch_command_s, {0.03, 0.25},
             "The robot halts when the pitch controller's speed bound is older.");
    v.number("pitch_state_stale_s", pitch_state_s, {0.03, 0.25},
             "The robot halts when the reading of the pitch servo is older.");
  }
};

struct NavigatorParams {
  robot::RobotParams robot;
  DriveParams drive;
  SteerParams steer;
  TurnParams turn;
  BackUpParams back_up;
  StalenessParams staleness;
  double drive_valid_s = 0.15;

  template <class Visitor>
  void describe(Visitor& v) {
    robot.describe(v);
    drive.describe(v);
    steer.describe(v);
    turn.describe(v);
    back_up.describe(v);
    staleness.describe(v);
    v.number("drive_valid_s", drive_valid_s, {0.05, 0.2}, "How long a DRIVE may be obeyed.");
  }
};

}  // namespace nodmap::navigator
