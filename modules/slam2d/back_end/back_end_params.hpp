// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/angle.hpp"

namespace nodmap::slam2d {

/// A keyframe matched against an older submap: which submaps, and which matches count.
struct LoopMatchParams {
  double max_distance_m = 3.0;
  double min_inlier_ratio = 0.6;
  double min_score = 0.7;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("max_distance_m", max_distance_m, {0.1, 50.0},
             "A keyframe is matched against older submaps with a keyframe within this distance, by "
             "the poses of the graph.");
    v.number("min_inlier_ratio", min_inlier_ratio, {0.0, 1.0},
             "The match closes a loop when at least this part of the scan has correspondences.");
    v.number("min_score", min_score, {0.0, 1.0},
             "The match closes a loop only if the points with correspondences score at least this "
             "on average.");
  }
};

/// The search for a loop where the pose graph is too unsure for a match alone.
struct LoopSearchParams {
  double max_distance_m = 30.0;
  double max_rotation_rad = geometry::deg_to_rad(40.0);
  double min_score = 0.5;
  double max_runner_up_ratio = 0.9;
  double min_inlier_ratio = 0.75;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number(
        "max_distance_m", max_distance_m, {0.1, 100.0},
        "A loop is searched for up to this distance from the pose of the graph, and no farther "
        "than three standard deviations of that pose.");
    v.angle("max_rotation_deg", max_rotation_rad, {0.0, 180.0},
            "A loop is searched for up to this rotation from the pose of the graph.");
    v.number("min_score", min_score, {0.05, 1.0},
             "A search finds nothing when the best mean likelihood is below this.");
    v.number("max_runner_up_ratio", max_runner_up_ratio, {0.1, 1.0},
             "A search is ambiguous when a second peak scores more than this ratio of the best.");
    v.number("min_inlier_ratio", min_inlier_ratio, {0.0, 1.0},
             "The match from the pose found counts when at least this part of the scan has "
             "correspondences.");
  }
};

/// When loops that were searched for are believed.
struct LoopConsensusParams {
  int min_keyframes = 3;
  double max_distance_m = 0.3;
  double max_rotation_rad = geometry::deg_to_rad(3.0);
  int max_age_keyframes = 40;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("min_keyframes", min_keyframes, {1, 100},
              "Loops found by a search are accepted when this many keyframes lead to the same pose "
              "of the newest keyframe.");
    v.number("max_distance_m", max_distance_m, {0.01, 10.0},
             "Poses of the newest keyframe within this distance count as the same.");
    v.angle("max_rotation_deg", max_rotation_rad, {0.1, 45.0},
            "Poses of the newest keyframe within this rotation count as the same.");
    v.integer("max_age_keyframes", max_age_keyframes, {1, 10000},
              "A loop that has not been accepted is dropped after this many keyframes.");
  }
};

struct LoopParams {
  LoopMatchParams match = {};
  LoopSearchParams search = {};
  LoopConsensusParams consensus = {};

  template <class Visitor>
  void describe(Visitor& v) {
    v.section("match", match);
    v.section("search", search);
    v.section("consensus", consensus);
  }
};

struct SubmapParams {
  int num_keyframes = 20;
  int max_keyframes_per_place = 20;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("num_keyframes", num_keyframes, {4, 1000}, "Number of keyframes in a submap.");
    v.integer("max_keyframes_per_place", max_keyframes_per_place, {0, 10000},
              "A submap is dropped once each of its keyframes has this many newer ones at its "
              "place: within 0.75 m and 30 degrees. 0: none is dropped.");
  }
};

struct PolishParams {
  int rounds = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("rounds", rounds, {0, 20},
              "At the end all keyframes are matched again, and their poses optimised, this many "
              "times.");
  }
};

/// Submaps, loops between them, and the pose graph.
struct BackEndParams {
  SubmapParams submap = {};
  LoopParams loop = {};
  PolishParams polish = {};

  template <class Visitor>
  void describe(Visitor& v) {
    v.section("submap", submap);
    v.section("loop", loop);
    v.section("polish", polish);
  }
};

}  // namespace nodmap::slam2d
