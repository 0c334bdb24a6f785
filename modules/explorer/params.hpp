// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/angle.hpp"
#include "common/robot/robot_params.hpp"

namespace nodmap::explorer {

/// How the next viewpoint is chosen.
enum class Policy : std::uint8_t {
  kTour,             ///< by a short tour over the best viewpoints
  kNearestFrontier,  ///< the nearest frontier (Yamauchi 1997), for comparison
};

struct ViewParams {
  double range_m = 6.0;
  double unknown_depth_m = 3.0;
  double half_angle_rad = geometry::deg_to_rad(90.0);
  double min_gain_m2 = 0.4;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("range_m", range_m, {1.0, 50.0},
             "A viewpoint's gain is the unknown area within this range that no known obstacle "
             "hides.");
    v.number("unknown_depth_m", unknown_depth_m, {0.5, 50.0},
             "Length of unknown ground through which a beam is assumed to pass; behind it a wall "
             "is as likely as a room.");
    v.angle("half_angle_deg", half_angle_rad, {10.0, 180.0}, "Half of the laser's field of view.");
    v.number("min_gain_m2", min_gain_m2, {0.02, 100.0},
             "Smallest gain; viewpoints that would show less are not visited.");
  }
};

struct TourParams {
  int max_viewpoints = 8;
  double discount_per_m = 0.6;
  double home_weight_m2 = 40.0;
  double min_gain_m2_per_m = 0.2;
  double always_gain_m2 = 4.0;
  double hysteresis_ratio = 0.15;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("max_viewpoints", max_viewpoints, {1, 10},
              "Greatest number of viewpoints in a tour. They are chosen one by one, each by what "
              "it would show in addition to the previous ones.");
    v.number("discount_per_m", discount_per_m, {0.0, 5.0},
             "When viewpoints are chosen, each gain is multiplied by exp(-discount_per_m x path "
             "length).");
    v.number("home_weight_m2", home_weight_m2, {0.0, 1000.0},
             "Weight of the tour's total length, including the path home, compared with the "
             "unknown area that waits while the robot drives.");
    v.number("min_gain_m2_per_m", min_gain_m2_per_m, {0.0, 10.0},
             "A run of successive viewpoints is left out of the tour when it shows less than this "
             "for each metre that it costs.");
    v.number("always_gain_m2", always_gain_m2, {0.0, 1000.0},
             "A run of successive viewpoints that shows at least this much is not left out: such "
             "an area is a room that was never seen, not a corner.");
    v.number(
        "hysteresis_ratio", hysteresis_ratio, {0.0, 1.0},
        "The present viewpoint is kept while its tour costs at most this fraction more than the "
        "best one.");
  }
};

struct PatienceParams {
  double stuck_s = 15.0;
  double no_path_s = 8.0;
  double look_s = 2.0;
  double retry_s = 30.0;
  int max_tries = 3;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number(
        "stuck_s", stuck_s, {2.0, 300.0},
        "A viewpoint has failed when the robot has not come nearer to it for this long, and the "
        "way home when there is no path for this long.");
    v.number("no_path_s", no_path_s, {1.0, 300.0},
             "A viewpoint has failed when the navigator has found no path to it for this long.");
    v.number("look_s", look_s, {0.5, 60.0},
             "A viewpoint that the robot has visited is left out for this long, until what was "
             "seen from there is in the map; twice as long after each further visit.");
    v.number("retry_s", retry_s, {1.0, 3600.0},
             "The surroundings of a failed viewpoint are excluded for this long, twice as long "
             "after each further failure; they are tried again sooner when nothing else is left.");
    v.integer("max_tries", max_tries, {1, 10},
              "A viewpoint is given up after this many visits; it and its surroundings are given "
              "up after this many failures.");
  }
};

struct ExplorerParams {
  robot::RobotParams robot;
  Policy policy = Policy::kTour;
  bool start = false;
  double side_margin_m = 0.04;
  double goal_tolerance_m = 0.3;
  double home_tolerance_m = 0.05;
  ViewParams view;
  TourParams tour;
  PatienceParams patience;

  template <class Visitor>
  void describe(Visitor& v) {
    robot.describe(v);
    v.choice("policy", policy,
             {{"tour", Policy::kTour}, {"nearest_frontier", Policy::kNearestFrontier}},
             "How the next viewpoint is chosen; nearest_frontier is for comparison.");
    v.flag("start", start, "Start with the first map, without waiting for EXPLORE.");
    v.number("side_margin_m", side_margin_m, {0.0, 1.0},
             "Margin on each side of the body on the path to a viewpoint.");
    v.number("goal_tolerance_m", goal_tolerance_m, {0.05, 2.0},
             "Tolerance of viewpoints and waypoints.");
    v.number("home_tolerance_m", home_tolerance_m, {0.02, 2.0},
             "Tolerance of home, where the exploration started.");
    v.section("view", view);
    v.section("tour", tour);
    v.section("patience", patience);
    v.renamed("clearance_m", "side_margin_m");
    v.renamed("patience.max_failures", "patience.max_tries");
  }
};

}  // namespace nodmap::explorer
