// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "modules/slam2d/back_end/back_end.hpp"
#include "modules/slam2d/front_end/doubt.hpp"
#include "modules/slam2d/front_end/moving_points.hpp"
#include "modules/slam2d/matching/pose_search.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/pose_update.hpp"
#include "modules/slam2d/scan/level_scan.hpp"

namespace nodmap::slam2d {

/// The pose guesses from which matching begins.
struct StartPoses {
  std::vector<geometry::SE2> guesses;  ///< of T_submap_base, in the local submap; the best first
  bool is_by_odometry = true;          ///< the best guess is the pose by odometry
  /// The match of all points of the scan from the best guess, if it was made.
  std::optional<Match> match = std::nullopt;
};

/// The pose at which a scan fits the local submap, and whether every other place is excluded.
struct MatchedPose {
  Match match;
  bool is_sure = true;
};

/// Finds the place of a scan in the local submap: by a match from odometry or, if that does not
/// fit, by a search. The search stays near odometry while odometry can be trusted; otherwise it
/// covers all places where the robot may be.
class PlaceSearch {
 public:
  /// `views`: what was seen from here. All three must outlive the search.
  PlaceSearch(const Slam2dParams& params, BackEnd& back_end, const MovingPointFilter& views,
              const Doubt& doubt);

  /// Chooses the guess from which the scan fits clearly best, and puts it first. Several guesses
  /// mean that odometry contradicts the robot's motion. Then all points are used, because moving
  /// points are detected by odometry.
  [[nodiscard]] StartPoses choose_start(const LevelScan& all_points,
                                        std::vector<geometry::SE2> guesses) const;

  /// Matches from the best guess, without a search.
  [[nodiscard]] Match match(const LevelScan& scan, const StartPoses& start) const;

  /// Matches or searches. `scan`: the part of `all_points` that has not moved.
  [[nodiscard]] MatchedPose find(const LevelScan& scan, const LevelScan& all_points,
                                 const StartPoses& start);

  /// Allows another search at the same place after one that failed: since then the robot may have
  /// been carried, and farther than was searched.
  void forget_failure() { T_odom_failed_.reset(); }

  [[nodiscard]] const SearchCounts& counts() const { return counts_; }

 private:
  [[nodiscard]] bool is_good(const Match& tracked) const;
  [[nodiscard]] bool is_certain(const Match& match) const;
  [[nodiscard]] bool is_plausible(const Match& match, const LevelScan& all_points,
                                  std::span<const geometry::SE2> guesses) const;
  [[nodiscard]] std::optional<MatchedPose> find_near(const LevelScan& scan,
                                                     const LevelScan& all_points,
                                                     std::span<const geometry::SE2> guesses,
                                                     const Match& tracked) const;
  [[nodiscard]] MatchedPose find_anywhere(const LevelScan& scan,
                                          std::span<const geometry::SE2> guesses,
                                          const Match& tracked) const;

  BackEnd& back_end_;
  const MovingPointFilter& views_;
  const Doubt& doubt_;
  MatcherParams matcher_params_;
  SearchParams search_params_;
  DoubtParams doubt_params_;
  KeyframeParams keyframe_params_;
  ScanMatcher matcher_;
  PoseSearch search_;
  std::optional<geometry::SE2> T_odom_failed_;  // of the last search, if it failed
  SearchCounts counts_;
};

}  // namespace nodmap::slam2d
