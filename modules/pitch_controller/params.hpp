// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/robot/robot_params.hpp"

namespace nodmap::pitch_controller {

/// `kNodding` as in the paper; `kFixed` holds the laser level: blind to everything above and below.
enum class Mode : std::uint8_t { kNodding, kFixed };

struct PitchControllerParams {
  Mode mode = Mode::kNodding;

  robot::RobotParams robot;
  double visible_obstacle_m = 0.05;

  double scan_period_s = 0.01332;

  double acceleration_mps2 = 0.5;
  double processing_s = 0.05;
  double look_ahead_m = 4.0;
  double fast_mps = 1.0;
  double top_mps = 2.0;

  double regulator_p = 0.1;
  double regulator_i = 0.6;
  double input_timeout_s = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("mode", mode, {{"nodding", Mode::kNodding}, {"fixed", Mode::kFixed}},
             "Nod, or hold the laser level: UNSAFE, sees one plane only, for comparisons.");
    robot.describe(v);
    describe_corridor(v);
    describe_driving(v);
    v.number("regulator_p", regulator_p, {0.0, 0.5},
             "Share of a sweep's error in time that the next one makes up for.");
    v.number("regulator_i", regulator_i, {0.0, 1.0},
             "Share of a sweep's error in time that is made up for ever after.");
    v.number("input_timeout_s", input_timeout_s, {0.03, 0.2},
             "ODOMETRY and PITCH_STATE older than this let nobody drive.");
  }

 private:
  template <class Visitor>
  void describe_corridor(Visitor& v) {
    v.number("visible_obstacle_m", visible_obstacle_m, {0.01, 1.0},
             "How far the lowest obstacle that has to be found rises above floor_tolerance_m.");
    v.number("scan_period_s", scan_period_s, {0.002, 0.2}, "From one scan to the next.");
  }

  template <class Visitor>
  void describe_driving(Visitor& v) {
    v.number("acceleration_mps2", acceleration_mps2, {0.05, 10.0},
             "How fast the speed bound rises, so that no period of the nod is outrun.");
    v.number("processing_s", processing_s, {0.0, 1.0},
             "From a beam that meets an obstacle to wheels that slow down.");
    v.number("look_ahead_m", look_ahead_m, {0.5, 30.0},
             "How far ahead of the robot's front something is found for certain, at most.");
    v.number("fast_mps", fast_mps, {0.1, 5.0},
             "From this speed on the sweep covers the virtual corridor and no more.");
    v.number("top_mps", top_mps, {0.0, 5.0}, "No speed above is ever allowed.");
  }
};

}  // namespace nodmap::pitch_controller
