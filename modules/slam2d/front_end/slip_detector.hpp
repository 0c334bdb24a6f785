// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "modules/slam2d/back_end/back_end.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan/level_scan.hpp"

namespace nodmap::slam2d {

/// What a scan says about odometry since the last scan.
struct SlipFinding {
  /// The match of the scan from the pose by odometry; only set if it was made, and neither of the
  /// following is set.
  std::optional<Match> match = std::nullopt;
  /// Where the robot is, if its wheels have moved farther than itself.
  std::optional<geometry::SE2> T_map_base = std::nullopt;
  /// The points to match: without somebody who walks ahead of the robot, if there is somebody.
  std::vector<OrientedPoint> points_without_people = {};
};

/// Detects wheel slip between two scans that are far apart.
///
/// A match from odometry cannot undo much slip: along the walls beside the robot nothing holds the
/// pose back, and the wall ahead is soon farther off than correspondences reach. The scan is
/// therefore also matched from poses short of odometry, down to that of the last scan.
///
/// But somebody who walks ahead of the robot keeps his place relative to it, as if it did not move.
/// The robot has slipped if the points that fit only there are a wall, or were seen there from
/// elsewhere before; otherwise they are somebody.
class SlipDetector {
 public:
  /// `back_end` must outlive it.
  SlipDetector(const Slam2dParams& params, const BackEnd& back_end)
      : back_end_(back_end),
        matcher_(params.matcher),
        min_score_(params.doubt.certain_score),
        min_gain_(params.search.min_gain) {}

  /// `T_map_last`: the pose of the last scan. `T_map_odometry`: that of `scan`, by odometry since
  /// then.
  [[nodiscard]] SlipFinding check(const LevelScan& scan, const geometry::SE2& T_map_last,
                                  const geometry::SE2& T_map_odometry) const;

 private:
  [[nodiscard]] std::optional<Match> find_better(const LevelScan& scan,
                                                 const geometry::SE2& T_submap_last,
                                                 const geometry::SE2& T_submap_odometry,
                                                 double min_score) const;
  [[nodiscard]] bool was_seen_from_elsewhere(const std::vector<OrientedPoint>& points_map,
                                             const geometry::SE2& T_map_last) const;

  const BackEnd& back_end_;
  ScanMatcher matcher_;
  double min_score_;
  double min_gain_;
};

}  // namespace nodmap::slam2d
