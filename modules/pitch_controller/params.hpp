// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/robot/robot_params.hpp"

namespace nodmap::pitch_controller {

/// `kNodding` nods as in the paper; `kFixed` holds the laser level, blind above and below its
/// plane.
enum class Mode : std::uint8_t { kNodding, kFixed };

/// The obstacles that the laser must detect, and how soon the robot reacts to them.
struct DetectionParams {
  double visible_obstacle_m = 0.05;
  double look_ahead_m = 4.0;
  double scan_period_s = 0.01332;
  double processing_s = 0.05;

  /// Time from the appearance of an obstacle until the wheels slow down, seconds. At the ends of
  /// the sweep the laser sees a place only once in two sweeps.
  [[nodiscard]] double reaction_s(double sweep_s) const { return 2.0 * sweep_s + processing_s; }

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("visible_obstacle_m", visible_obstacle_m, {0.01, 1.0},
             "Smallest obstacle that must be detected, by its height above floor_tolerance_m.");
    v.number("look_ahead_m", look_ahead_m, {0.5, 30.0},
             "Farthest distance ahead of the robot's front at which it must be detected.");
    v.number("scan_period_s", scan_period_s, {0.002, 0.2}, "Time between scans.");
    v.number("processing_s", processing_s, {0.0, 1.0},
             "Time from a beam that hits an obstacle until the wheels slow down.");
  }
};

struct SpeedParams {
  double fast_mps = 1.0;
  /// At higher speeds the maps do not show the smallest obstacle as far ahead as the sweeps are
  /// dense enough for it (README, Limits).
  double top_mps = 1.7;
  double acceleration_mps2 = 0.5;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("fast_mps", fast_mps, {0.1, 5.0},
             "From this speed on, the area of interest is only the virtual corridor.");
    v.number("top_mps", top_mps, {0.0, 5.0}, "Upper limit of the speed bound.");
    v.number("acceleration_mps2", acceleration_mps2, {0.05, 10.0},
             "How fast the speed bound may rise.");
  }
};

/// Gains of the PI controller of the sweep duration.
struct RegulatorParams {
  double p = 0.1;
  double i = 0.6;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("p", p, {0.0, 0.5},
             "Proportional gain: part of a sweep's relative time error corrected in the next.");
    v.number("i", i, {0.0, 1.0},
             "Integral gain: part of a sweep's relative time error added to all that follow.");
  }
};

struct PitchControllerParams {
  Mode mode = Mode::kNodding;
  bool follows_path = false;
  robot::RobotParams robot;
  DetectionParams detection;
  SpeedParams speed;
  RegulatorParams regulator;
  double input_timeout_s = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("mode", mode, {{"nodding", Mode::kNodding}, {"fixed", Mode::kFixed}},
             "Nod, or hold the laser level. Fixed is UNSAFE and for comparisons only: it sees one "
             "plane.");
    v.flag("follows_path", follows_path,
           "Nod by plan: look as far as the arc that the navigator has chosen is free, and down at "
           "ground that was not seen; otherwise by the speed alone.");
    robot.describe(v);
    v.section("detection", detection);
    v.section("speed", speed);
    v.section("regulator", regulator);
    v.number("input_timeout_s", input_timeout_s, {0.03, 0.2},
             "Driving is inhibited when ODOMETRY or PITCH_STATE is older than this.");
    describe_former_names(v);
  }

 private:
  template <class Visitor>
  static void describe_former_names(Visitor& v) {
    for (const char* name :
         {"visible_obstacle_m", "look_ahead_m", "scan_period_s", "processing_s"}) {
      v.renamed(name, std::string("detection.") + name);
    }
    for (const char* name : {"fast_mps", "top_mps", "acceleration_mps2"}) {
      v.renamed(name, std::string("speed.") + name);
    }
    v.renamed("regulator_p", "regulator.p");
    v.renamed("regulator_i", "regulator.i");
  }
};

}  // namespace nodmap::pitch_controller
