// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/angle.hpp"

namespace nodmap::slam6d {

/// What the registration makes small (see registration.hpp).
enum class Metric { kPaper, kPlanes };

struct Slam6dParams {
  // Sweeps (IV B).
  double reversal_hysteresis_rad = geometry::deg_to_rad(1.0);
  double jump_back_rad = geometry::deg_to_rad(10.0);
  double gap_s = 1.0;
  int max_scans = 1000;
  int min_scans = 10;
  // What of a scan is used.
  double min_range_m = 0.5;
  double max_range_m = 30.0;
  bool assume_standing = false;
  // Which sweeps are registered (IV B).
  double keyframe_distance_m = 1.0;
  double keyframe_rotation_rad = geometry::deg_to_rad(45.0);
  bool standing_only = false;
  // Surfaces.
  double point_spacing_m = 0.1;
  int plane_neighbours = 16;
  double plane_radius_m = 0.6;
  // Registration (Eq. 3).
  Metric metric = Metric::kPlanes;
  double max_correspondence_m = 1.0;
  double min_correspondence_m = 0.25;
  double residual_scale_m = 0.03;
  double min_constraint = 0.003;
  double min_match_share = 0.15;
  int iterations = 60;
  double ground_weight = 0.3;
  // Occupancy map.
  double map_resolution_m = 0.05;
  double map_max_range_m = 10.0;
  int save_every_keyframes = 10;
  double octomap_period_s = 5.0;
  bool save_ot = false;

  template <class Visitor>
  void describe(Visitor& v) {
    describe_sweeps(v);
    describe_registration(v);
    describe_map(v);
  }

 private:
  template <class Visitor>
  void describe_sweeps(Visitor& v) {
    v.angle("reversal_hysteresis_deg", reversal_hysteresis_rad, {0.01, 45.0},
            "A sweep ends at a turning point once the pitch has come back from it by this much.");
    v.angle(
        "jump_back_deg", jump_back_rad, {1.0, 180.0},
        "A pitch step against the movement beyond this is no turn but a new start of the sweep.");
    v.number("gap_s", gap_s, {0.05, 3600.0},
             "A pause between two scans beyond this interrupts the stream and ends the sweep.");
    v.integer("max_scans", max_scans, {2, 100000}, "A sweep ends when it has this many scans.");
    v.integer("min_scans", min_scans, {1, 1000},
              "A sweep with fewer scans is too thin to be registered.");
    v.number("min_range_m", min_range_m, {0.0, 10.0},
             "Points nearer to the mirror than this are the robot itself.");
    v.number("max_range_m", max_range_m, {0.5, 1000.0},
             "Points farther from the mirror than this are not used.");
    v.flag("assume_standing", assume_standing,
           "Takes the robot as standing still where a recording has no odometry at all.");
    v.number("keyframe_distance_m", keyframe_distance_m, {0.0, 100.0},
             "A sweep is registered when its base pose is farther than this from the last one's.");
    v.angle("keyframe_rotation_deg", keyframe_rotation_rad, {0.0, 180.0},
            "A sweep is registered when its base pose is turned by more than this.");
    v.flag("standing_only", standing_only,
           "Registers only sweeps during which the robot stood: stop, scan and go.");
  }

  template <class Visitor>
  void describe_registration(Visitor& v) {
    v.number("point_spacing_m", point_spacing_m, {0.01, 1.0},
             "Edge of the cube within which points are averaged, and least distance in the model.");
    v.integer("plane_neighbours", plane_neighbours, {4, 64},
              "Points that say which plane a point lies on.");
    v.number("plane_radius_m", plane_radius_m, {0.05, 5.0},
             "Neighbours farther than this make no plane.");
    v.choice("metric", metric, {{"paper", Metric::kPaper}, {"planes", Metric::kPlanes}},
             "What is made small: distances of paired points (Eq. 3), or from points to planes.");
    v.number("max_correspondence_m", max_correspondence_m, {0.01, 10.0},
             "Pairs farther apart than this are no correspondence in the first iteration.");
    v.number("min_correspondence_m", min_correspondence_m, {0.01, 10.0},
             "The same in the last iterations.");
    v.number("residual_scale_m", residual_scale_m, {0.001, 1.0},
             "A point at this distance from its plane counts half.");
    v.number("min_constraint", min_constraint, {0.0, 0.5},
             "A direction held by a smaller share of the scene's planes keeps the odometry.");
    v.number("min_match_share", min_match_share, {0.0, 1.0},
             "With a smaller share of points that found a partner the sweep keeps the odometry.");
    v.integer("iterations", iterations, {1, 1000}, "Most iterations of one registration.");
    v.number("ground_weight", ground_weight, {0.0, 100.0},
             "What it counts, beside all pairs, that the robot keeps to the plane of the ground on "
             "which it stood last; less, the farther the pairs are from it. 0: for what flies.");
  }

  template <class Visitor>
  void describe_map(Visitor& v) {
    v.number("map_resolution_m", map_resolution_m, {0.01, 1.0}, "Edge of an OctoMap voxel.");
    v.number("map_max_range_m", map_max_range_m, {0.5, 100.0},
             "Beams enter the OctoMap up to this length.");
    v.integer("save_every_keyframes", save_every_keyframes, {0, 100000},
              "Saves the OctoMap after so many keyframes; 0: only at the end and on request.");
    v.number("octomap_period_s", octomap_period_s, {0.0, 3600.0},
             "Publishes the OctoMap at most so often, after a keyframe; 0: never.");
    v.flag("save_ot", save_ot, "Saves map.ot, with probabilities, beside map.bt.");
  }
};

}  // namespace nodmap::slam6d
