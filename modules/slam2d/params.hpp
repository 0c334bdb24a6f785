// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/angle.hpp"

namespace nodmap::slam2d {

/// Which distances of Eq. 3 the last iterations count.
enum class Metric : std::uint8_t {
  kPoints,  ///< point to point, to the letter of the paper
  kLines,   ///< only across the line the map's points form
};

/// Submaps, loops between them, and when a loop is believed.
struct BackEndParams {
  int submap_keyframes = 20;
  double loop_distance_m = 3.0;
  double min_inlier_ratio = 0.6;
  double min_match_score = 0.7;
  double min_search_inlier_ratio = 0.75;
  double min_search_score = 0.5;
  double max_runner_up_ratio = 0.9;
  double max_search_distance_m = 10.0;
  double max_search_rotation_rad = geometry::deg_to_rad(40.0);
  int min_agreeing_loops = 3;
  double agreement_distance_m = 0.3;
  double agreement_rotation_rad = geometry::deg_to_rad(3.0);
  int pending_keyframes = 40;
  int polish_rounds = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("submap_keyframes", submap_keyframes, {4, 1000}, "Keyframes of a submap.");
    v.number("loop_distance_m", loop_distance_m, {0.1, 50.0},
             "Submaps are matched whose keyframes come this near, by the pose of the graph.");
    v.number("min_inlier_ratio", min_inlier_ratio, {0.0, 1.0},
             "A match with an older submap counts when this share of the scan lies on it.");
    v.number("min_match_score", min_match_score, {0.0, 1.0},
             "And when those points agree with it at least this well.");
    v.number("min_search_inlier_ratio", min_search_inlier_ratio, {0.0, 1.0},
             "The share of a scan that has to lie on a submap found by a search.");
    v.number("min_search_score", min_search_score, {0.05, 1.0},
             "Mean likelihood below which a search finds nothing.");
    v.number("max_runner_up_ratio", max_runner_up_ratio, {0.1, 1.0},
             "A search whose second peak scores more than this share of the best is ambiguous.");
    v.number("max_search_distance_m", max_search_distance_m, {0.1, 100.0},
             "How far from the pose of the graph loops are searched for at most.");
    v.angle("max_search_rotation_deg", max_search_rotation_rad, {0.0, 180.0},
            "How far turned from the pose of the graph loops are searched for at most.");
    v.integer("min_agreeing_loops", min_agreeing_loops, {1, 100},
              "Loops found by a search are believed when so many keyframes agree.");
    v.number("agreement_distance_m", agreement_distance_m, {0.01, 10.0},
             "How near the poses have to be that agreeing loops lead to.");
    v.angle("agreement_rotation_deg", agreement_rotation_rad, {0.1, 45.0},
            "And how far turned they may be.");
    v.integer("pending_keyframes", pending_keyframes, {1, 10000},
              "A loop found by a search waits for agreement during so many keyframes.");
    v.integer("polish_rounds", polish_rounds, {0, 20},
              "At the end all keyframes are matched anew this many times.");
  }
};

struct Slam2dParams {
  double max_level_pitch_rad = geometry::deg_to_rad(1.0);

  Metric metric = Metric::kLines;
  double max_correspondence_m = 0.7;
  double final_correspondence_m = 0.25;
  double line_correspondence_m = 0.08;
  int iterations = 30;
  double weak_direction_share = 0.02;

  double new_point_distance_m = 0.05;
  double line_radius_m = 0.13;
  double keyframe_distance_m = 0.3;
  double keyframe_rotation_rad = geometry::deg_to_rad(15.0);

  double search_below_agreement = 0.7;
  double search_distance_m = 0.75;
  double search_rotation_rad = geometry::deg_to_rad(90.0);
  double lost_below_agreement = 0.2;
  double lost_distance_m = 1.0;

  double cell_size_m = 0.05;
  double map_period_s = 20.0;

  BackEndParams back_end;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("max_level_pitch_deg", max_level_pitch_rad, {0.05, 5.0},
            "Of each half sweep the scan nearest to pitch 0 is used if it is at least this level.");
    v.choice("metric", metric, {{"lines", Metric::kLines}, {"points", Metric::kPoints}},
             "Distances that Eq. 3 counts at the end: points to the lines of the map, or points to "
             "points as in the paper.");
    v.number("max_correspondence_m", max_correspondence_m, {0.05, 5.0},
             "d_max of the first iterations: pairs farther apart are no correspondence.");
    v.number("final_correspondence_m", final_correspondence_m, {0.02, 5.0},
             "d_max of the last iterations that count distances to points.");
    v.number("line_correspondence_m", line_correspondence_m, {0.02, 5.0},
             "d_max of the last iterations that count distances to lines: they leave out what is "
             "near a line, but not of it.");
    v.integer("iterations", iterations, {1, 200}, "Iterations of ICP at most.");
    v.number("weak_direction_share", weak_direction_share, {0.0, 0.5},
             "A direction on which the pairs hold less than this share of the information they "
             "could hold is left to odometry.");
    v.number("new_point_distance_m", new_point_distance_m, {0.005, 1.0},
             "d_new: a scan point is added when no point of the map is this near.");
    v.number("line_radius_m", line_radius_m, {0.02, 2.0},
             "Neighbours up to here form the line through a point of the map. Wider lines average "
             "more noise, "
             "but bridge the steps at door frames and niches.");
    v.number("keyframe_distance_m", keyframe_distance_m, {0.0, 10.0},
             "Points are added to the map after this way since the last time.");
    v.angle("keyframe_rotation_deg", keyframe_rotation_rad, {0.0, 180.0},
            "Points are added to the map after this turn since the last time.");
    v.number("search_below_agreement", search_below_agreement, {0.0, 1.0},
             "Below this agreement of scan and map other start poses are tried.");
    v.number("search_distance_m", search_distance_m, {0.0, 5.0},
             "How far from odometry start poses are tried.");
    v.angle("search_rotation_deg", search_rotation_rad, {0.0, 180.0},
            "How far turned from odometry start poses are tried.");
    v.number("lost_below_agreement", lost_below_agreement, {0.0, 1.0},
             "Below this agreement the match is not believed.");
    v.number("lost_distance_m", lost_distance_m, {0.0, 100.0},
             "After this way without a match the map is continued from odometry.");
    v.number("cell_size_m", cell_size_m, {0.01, 1.0}, "Edge of a cell of the occupancy grid.");
    v.number("map_period_s", map_period_s, {0.1, 3600.0},
             "MAP_2D is sent after this time if the map has changed.");
    back_end.describe(v);
  }
};

}  // namespace nodmap::slam2d
