// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/angle.hpp"
#include "common/geometry/pose_tolerance.hpp"
#include "common/geometry/se2.hpp"
#include "modules/slam2d/back_end/back_end_params.hpp"

namespace nodmap::slam2d {

struct LevelScanParams {
  double max_pitch_rad = geometry::deg_to_rad(1.0);
  bool leave_out_slopes = true;
  bool from_structure_map = false;
  double structure_period_s = 0.3;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("max_pitch_deg", max_pitch_rad, {0.05, 5.0},
            "Of each sweep the scan with the pitch nearest to 0 is used, if its pitch is at most "
            "this.");
    v.flag("leave_out_slopes", leave_out_slopes,
           "Leave out the points of a level scan that are on ramps, as the scans beside it in the "
           "sweep show.");
    v.flag(
        "from_structure_map", from_structure_map,
        "Instead of level scans, match the structure map (STRUCTURE_MAP): a virtual scan of walls, "
        "without what the sweeps see over (paper, section III B).");
    v.number("structure_period_s", structure_period_s, {0.0, 10.0},
             "Time from one structure map that is matched to the next.");
  }
};

/// How much of the robot's path is kept.
struct PathParams {
  int max_scans = 524'288;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("max_scans", max_scans, {2, 100'000'000},
              "Maximum number of level scans whose poses are kept, 64 bytes each. Beyond it every "
              "second scan is kept, then every fourth.");
  }
};

/// The distances that the last iterations of ICP minimise.
enum class ErrorMetric : std::uint8_t {
  kPointToPoint,  ///< Eq. 3 as printed in the paper
  kPointToLine,   ///< from points to the lines through the points of the map
};

struct MatcherParams {
  ErrorMetric metric = ErrorMetric::kPointToLine;
  double max_correspondence_distance_m = 0.7;
  double min_correspondence_distance_m = 0.25;
  double min_line_distance_m = 0.08;
  int max_iterations = 30;
  double min_information_ratio = 0.02;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("metric", metric,
             {{"point_to_line", ErrorMetric::kPointToLine},
              {"point_to_point", ErrorMetric::kPointToPoint}},
             "Distances that the last iterations minimise: from points to the lines of the map, or "
             "between points as in the paper's Eq. 3.");
    v.number("max_correspondence_distance_m", max_correspondence_distance_m, {0.05, 5.0},
             "Maximum correspondence distance d_max of the first iterations.");
    v.number("min_correspondence_distance_m", min_correspondence_distance_m, {0.02, 5.0},
             "d_max of the last iterations that minimise distances between points.");
    v.number("min_line_distance_m", min_line_distance_m, {0.02, 5.0},
             "d_max of the last iterations that minimise distances to lines. It leaves out points "
             "that are near a line but not part of it.");
    v.integer("max_iterations", max_iterations, {1, 200}, "Maximum number of ICP iterations.");
    v.number("min_information_ratio", min_information_ratio, {0.0, 0.5},
             "A direction is degenerate, and follows odometry, when the information on it is below "
             "this ratio of what the correspondences could give.");
  }
};

struct SearchParams {
  double score_threshold = 0.7;
  double distance_m = 0.75;
  double rotation_rad = geometry::deg_to_rad(90.0);
  double min_gain = 0.05;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("score_threshold", score_threshold, {0.0, 1.0},
             "Other start poses are tried when the match from odometry scores below this.");
    v.number("distance_m", distance_m, {0.0, 5.0},
             "Start poses are tried up to this distance from odometry, in x and in y.");
    v.angle("rotation_deg", rotation_rad, {0.0, 180.0},
            "Start poses are tried up to this rotation from odometry.");
    v.number("min_gain", min_gain, {0.0, 1.0},
             "A match from another start pose, or another guess, replaces the one from odometry "
             "when it scores more by at least this.");
  }
};

/// For the time in which odometry is in doubt: after a gap in it, and while the robot is lost.
struct DoubtParams {
  double certain_score = 0.85;
  double found_score = 0.6;
  double min_misfit_ratio = 1.5;
  double min_score = 0.5;
  double search_distance_m = 4.0;
  double search_rotation_rad = geometry::deg_to_rad(120.0);
  double min_search_score = 0.35;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("certain_score", certain_score, {0.0, 1.0},
             "A match that scores at least this, with all directions well determined, is believed "
             "without a search.");
    v.number("found_score", found_score, {0.0, 1.0},
             "The best place that a search finds is believed only if it scores at least this.");
    v.number(
        "min_misfit_ratio", min_misfit_ratio, {1.0, 100.0},
        "The best place that a search finds is believed only if the misfit (1 - score) of every "
        "other place is at least this many times its own. Otherwise the pose is DEGRADED.");
    v.number("min_score", min_score, {0.0, 1.0},
             "While odometry is in doubt, the robot is lost when no place scores at least this. "
             "Wrong places score up to about half, because walls of other rooms fit over part of "
             "their length.");
    v.number(
        "search_distance_m", search_distance_m, {0.1, 100.0},
        "The local submap, or the known map, is searched up to this distance from odometry, in "
        "x and in y; after a gap in odometry no farther than a robot can have driven in it.");
    v.angle("search_rotation_deg", search_rotation_rad, {0.0, 180.0},
            "The local submap, or the known map, is searched up to this rotation from odometry.");
    v.number("min_search_score", min_search_score, {0.05, 1.0},
             "The search finds nothing when the best mean likelihood is below this. It is low "
             "because much of the scan may show what is not in the local submap yet.");
  }
};

/// How far a match may be from odometry while wheels only slip.
struct SlipParams {
  double match_scatter_m = 0.03;
  double match_scatter_rad = geometry::deg_to_rad(1.7);
  double max_mps = 1.0;
  double max_rad_s = geometry::deg_to_rad(60.0);
  double max_ratio = 0.5;
  double effective_wheel_distance_m = 0.4;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("match_scatter_m", match_scatter_m, {0.0, 1.0},
             "Scatter of single matches about the true position.");
    v.angle("match_scatter_deg", match_scatter_rad, {0.0, 45.0},
            "Scatter of single matches about the true heading.");
    v.number("max_mps", max_mps, {0.0, 10.0},
             "Largest slip of the wheels from one scan to the next, in addition to the scatter.");
    v.angle("max_deg_s", max_rad_s, {0.0, 720.0},
            "Largest slip in rotation from one scan to the next, in addition to the scatter.");
    v.number("max_ratio", max_ratio, {0.0, 1.0},
             "Largest slip of the wheels since the last keyframe, as a ratio of what odometry has "
             "counted.");
    v.number("effective_wheel_distance_m", effective_wheel_distance_m, {0.05, 5.0},
             "If the wheels of one side slip, the robot rotates: by the slip divided by this "
             "distance, that of the wheels divided by the base's turning adaptation.");
  }
};

/// People may hide the view or shift the pose. While scans follow each other so quickly that the
/// robot cannot leave its course by odometry in between, it is not assumed to be elsewhere.
struct PeopleParams {
  double min_scan_period_s = 0.005;
  double max_scan_period_s = 0.05;
  double max_hidden_s = 1.0;
  SlipParams slip = {};

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("max_scan_period_s", max_scan_period_s, {0.0, 1.0},
             "Scans farther apart than this are matched as if nobody hid the view, because the "
             "robot may have been pushed in between. 0: all scans are.");
    v.number(
        "min_scan_period_s", min_scan_period_s, {0.0, 1.0},
        "Scans nearer together than this are also matched as if nobody hid the view: their stamps "
        "come in bursts and give no speed.");
    v.number("max_hidden_s", max_hidden_s, {0.0, 3600.0},
             "People pass within this time. If the view is hidden for longer, the robot was "
             "carried to another place.");
    v.section("slip", slip);
  }
};

struct KeyframeParams {
  double distance_m = 0.3;
  double nodding_distance_m = 0.2;
  double rotation_rad = geometry::deg_to_rad(15.0);

  /// Whether the robot has moved from `before` to `now` by more than keyframes are apart.
  [[nodiscard]] bool is_beyond(const geometry::SE2& before, const geometry::SE2& now) const {
    return !geometry::is_within(before, now, {distance_m, rotation_rad});
  }

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("distance_m", distance_m, {0.0, 10.0},
             "A scan becomes a keyframe, and goes into the map, beyond this distance from the last "
             "keyframe by odometry.");
    v.number(
        "nodding_distance_m", nodding_distance_m, {0.0, 10.0},
        "The distance beyond which a level scan of a nodding scanner becomes a keyframe: there "
        "are so few that all of them are needed where the robot drives.");
    v.angle("rotation_deg", rotation_rad, {0.0, 180.0},
            "A scan also becomes a keyframe beyond this rotation from the last keyframe.");
  }
};

struct LostParams {
  double score_threshold = 0.2;
  double distance_m = 1.0;
  double max_s = 10.0;
  double max_sigma_m = 0.4;
  double begin_sigma_m = 3.0;
  double begin_sigma_rad = geometry::deg_to_rad(30.0);
  double max_drift_sigma_m = 1.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("score_threshold", score_threshold, {0.0, 1.0},
             "The robot is lost when a match scores below this.");
    v.number("distance_m", distance_m, {0.0, 100.0},
             "While the robot's place is in doubt, the map is continued from odometry beyond this "
             "distance from the last keyframe.");
    v.number(
        "max_s", max_s, {0.0, 3600.0},
        "While the robot's place is in doubt, the map is also continued from odometry after this "
        "time.");
    v.number(
        "max_sigma_m", max_sigma_m, {0.01, 100.0},
        "By odometry alone the robot is lost where the standard deviation of its position is above "
        "this, as after some 10 m: in x or in y if the scan fits nothing, in every direction if it "
        "has too few points.");
    v.number("begin_sigma_m", begin_sigma_m, {0.1, 100.0},
             "Standard deviation of the place at which a lost robot continues the map.");
    v.angle("begin_sigma_deg", begin_sigma_rad, {1.0, 180.0},
            "Standard deviation of the heading with which a lost robot continues the map.");
    v.number("max_drift_sigma_m", max_drift_sigma_m, {0.01, 100.0},
             "The pose is DEGRADED as long as the standard deviation of the drift since the map "
             "began is above this: goals in map are off by as much.");
  }
};

struct MapParams {
  double new_point_distance_m = 0.05;
  double line_radius_m = 0.13;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("new_point_distance_m", new_point_distance_m, {0.005, 1.0},
             "d_new: a scan point is added to the map when no map point is within this distance.");
    v.number(
        "line_radius_m", line_radius_m, {0.02, 2.0},
        "The line through a map point is fitted to its neighbours within this radius. A larger "
        "one averages more noise, but bridges the steps at door frames and niches.");
  }
};

struct GridParams {
  double cell_size_m = 0.05;
  double publish_period_s = 1.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("cell_size_m", cell_size_m, {0.01, 1.0}, "Edge length of an occupancy grid cell.");
    v.number("publish_period_s", publish_period_s, {0.1, 3600.0},
             "MAP_2D is published at most this often: the tiles that have changed, and some of the "
             "others in turn.");
  }
};

/// When a place found in a known map is believed.
struct RelocaliserParams {
  double min_search_score = 0.4;
  double min_peak_ratio = 0.85;
  double min_score = 0.5;
  double min_misfit_ratio = 1.5;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("min_search_score", min_search_score, {0.05, 1.0},
             "Poses whose mean likelihood is below this are not considered.");
    v.number("min_peak_ratio", min_peak_ratio, {0.1, 1.0},
             "Poses whose mean likelihood is below this ratio of the best are not considered.");
    v.number("min_score", min_score, {0.0, 1.0},
             "The robot is lost when no place scores at least this: the score of the match, less "
             "the part of the points that were measured through walls.");
    v.number("min_misfit_ratio", min_misfit_ratio, {1.0, 100.0},
             "The robot also stays lost if the misfit (1 - score) of another place is less than "
             "this many times that of the best.");
  }
};

/// When a pose in a known map is given up.
struct LocaliserParams {
  double min_score = 0.5;
  double max_misfit_s = 2.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("min_score", min_score, {0.0, 1.0},
             "A scan does not fit the known map when its match scores below this, less the part of "
             "the points that were measured through walls.");
    v.number(
        "max_misfit_s", max_misfit_s, {0.0, 3600.0},
        "The robot is lost once scans have not fitted for this time; it follows odometry until "
        "then. Scans with too few points do not count.");
  }
};

struct Slam2dParams {
  LevelScanParams level_scans = {};
  MatcherParams matcher = {};
  SearchParams search = {};
  DoubtParams doubt = {};
  PeopleParams people = {};
  KeyframeParams keyframe = {};
  LostParams lost = {};
  PathParams path = {};
  MapParams map = {};
  BackEndParams back_end = {};
  GridParams grid = {};
  RelocaliserParams relocalise = {};
  LocaliserParams localise = {};

  template <class Visitor>
  void describe(Visitor& v) {
    v.section("level_scans", level_scans);
    v.section("matcher", matcher);
    v.section("search", search);
    v.section("doubt", doubt);
    v.section("people", people);
    v.section("keyframe", keyframe);
    v.section("lost", lost);
    v.section("path", path);
    v.section("map", map);
    back_end.describe(v);  // submap, loop, polish
    v.section("grid", grid);
    v.section("relocalise", relocalise);
    v.section("localise", localise);
    describe_renamed(v);
  }

 private:
  template <class Visitor>
  static void describe_renamed(Visitor& v) {
    v.renamed("max_level_pitch_deg", "level_scans.max_pitch_deg");
    v.renamed("metric", "matcher.metric");
    v.renamed("max_correspondence_m", "matcher.max_correspondence_distance_m");
    v.renamed("final_correspondence_m", "matcher.min_correspondence_distance_m");
    v.renamed("line_correspondence_m", "matcher.min_line_distance_m");
    v.renamed("iterations", "matcher.max_iterations");
    v.renamed("weak_direction_share", "matcher.min_information_ratio");
    v.renamed("new_point_distance_m", "map.new_point_distance_m");
    v.renamed("line_radius_m", "map.line_radius_m");
    v.renamed("keyframe_distance_m", "keyframe.distance_m");
    v.renamed("keyframe_rotation_deg", "keyframe.rotation_deg");
    v.renamed("search_below_agreement", "search.score_threshold");
    v.renamed("search_distance_m", "search.distance_m");
    v.renamed("search_rotation_deg", "search.rotation_deg");
    v.renamed("lost_below_agreement", "lost.score_threshold");
    v.renamed("lost_distance_m", "lost.distance_m");
    v.renamed("cell_size_m", "grid.cell_size_m");
    v.renamed("map_period_s", "grid.publish_period_s");
    v.renamed("people.slip.max_m_per_s", "people.slip.max_mps");
    v.renamed("people.slip.max_deg_per_s", "people.slip.max_deg_s");
    v.renamed("people.slip.wheel_distance_m", "people.slip.effective_wheel_distance_m");
  }
};

}  // namespace nodmap::slam2d
