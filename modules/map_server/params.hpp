// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/angle.hpp"
#include "common/robot/robot_params.hpp"

namespace nodmap::map_server {

/// How a stored point is kept up to date: `kPaper` as printed, `kConfirmed` with its gaps closed.
enum class Rule { kPaper, kConfirmed };

struct MapServerParams {
  double aperture_rad = geometry::deg_to_rad(360.0);
  double resolution_rad = geometry::deg_to_rad(1.0);

  robot::RobotParams robot;
  double base_height_m = 0.0;

  double range_sigma_m = 0.01;
  double pitch_sigma_rad = geometry::deg_to_rad(0.1);

  Rule update_rule = Rule::kConfirmed;
  double expiry_s = 5.0;
  double height_tolerance_m = 0.02;
  int misses_to_remove = 2;

  bool assume_standing = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("aperture_deg", aperture_rad, {1.0, 360.0},
            "Apex angle of both maps, centred ahead (paper, III B).");
    v.angle("resolution_deg", resolution_rad, {0.1, 10.0}, "Angle from bin to bin.");
    robot.describe(v);
    v.number("base_height_m", base_height_m, {-0.5, 5.0},
             "Height of the base frame above the ground; not 0 only for recordings whose base is "
             "the scanner.");
    v.number("range_sigma_m", range_sigma_m, {0.0, 0.5}, "Standard deviation of a range.");
    v.angle("pitch_sigma_deg", pitch_sigma_rad, {0.0, 5.0},
            "Standard deviation of the pitch; widens the floor tolerance with distance.");
    v.choice("update_rule", update_rule, {{"paper", Rule::kPaper}, {"confirmed", Rule::kConfirmed}},
             "How points are kept: as in the paper, or until contradicted.");
    v.number("expiry_s", expiry_s, {0.1, 600.0},
             "A point goes after this long: paper: in motion; confirmed: in full view, without "
             "having been measured again.");
    v.number("height_tolerance_m", height_tolerance_m, {0.0, 0.5},
             "Heights nearer than this count as the same part of an object (confirmed only).");
    v.integer("misses_to_remove", misses_to_remove, {1, 100},
              "A point is removed when beams passed it in this many sweeps in a row (confirmed "
              "only).");
    v.flag("assume_standing", assume_standing,
           "Treat the robot as standing: for recordings without odometry.");
  }
};

}  // namespace nodmap::map_server
