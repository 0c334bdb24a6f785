// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/angle.hpp"
#include "common/robot/robot_params.hpp"

namespace nodmap::explorer {

/// How the next viewpoint is chosen.
enum class Policy : std::uint8_t {
  kTour,             ///< by a short tour over the best viewpoints
  kNearestFrontier,  ///< the nearest frontier cell (Yamauchi 1997), to compare with
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
             "A beam counts as passing through unknown ground for this length at most: behind it "
             "a wall is as likely as a room.");
    v.angle("half_angle_deg", half_angle_rad, {10.0, 180.0}, "Half of the laser's field of view.");
    v.number("min_gain_m2", min_gain_m2, {0.02, 100.0},
             "Viewpoints that would show less are not worth the path.");
  }
};

struct TourParams {
  int max_viewpoints = 8;
  double discount_per_m = 0.6;
  double home_weight_m2 = 40.0;
  double hysteresis_ratio = 0.15;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("max_viewpoints", max_viewpoints, {1, 10},
              "Greatest number of viewpoints in a tour; the best are chosen one after the other, "
              "each by what the ones before it do not show.");
    v.number("discount_per_m", discount_per_m, {0.0, 5.0},
             "For the choice a viewpoint's gain falls by exp(-this x path length).");
    v.number("home_weight_m2", home_weight_m2, {0.0, 1000.0},
             "Weight of the tour's whole length, with the path back home, beside the unknown area "
             "that still waits while the robot drives.");
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
  int max_failures = 3;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("stuck_s", stuck_s, {2.0, 300.0},
             "A viewpoint has failed when the robot has come no nearer to it for this long.");
    v.number("no_path_s", no_path_s, {1.0, 300.0},
             "A viewpoint has failed when the navigator has found no path to it for this long.");
    v.number(
        "look_s", look_s, {0.5, 60.0},
        "A viewpoint has failed when the robot has been there for this long and the map still does "
        "not show what it should have seen.");
    v.number(
        "retry_s", retry_s, {1.0, 3600.0},
        "The surroundings of a failed viewpoint are left out for this long, after each further "
        "failure for twice as long; they are tried again sooner when nothing else is left.");
    v.integer("max_failures", max_failures, {1, 10},
              "After this many failures the surroundings of a viewpoint are given up.");
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
             "How the next viewpoint is chosen; nearest_frontier is there to compare with.");
    v.flag("start", start, "Explore from the first map on, without waiting for EXPLORE.");
    v.number("side_margin_m", side_margin_m, {0.0, 1.0},
             "Margin on each side of the body that the path to a viewpoint keeps.");
    v.number("goal_tolerance_m", goal_tolerance_m, {0.05, 2.0},
             "Tolerance of the goals on the way.");
    v.number("home_tolerance_m", home_tolerance_m, {0.02, 2.0},
             "Tolerance of the last goal, where the exploration began.");
    v.section("view", view);
    v.section("tour", tour);
    v.section("patience", patience);
    v.renamed("clearance_m", "side_margin_m");
  }
};

}  // namespace nodmap::explorer
