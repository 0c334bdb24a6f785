// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "modules/slam2d/matching/point_map.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// Finds the robot again where matching from odometry fails: after wheel slip, a gap in a recording
/// or when it was carried.
class PoseSearch {
 public:
  explicit PoseSearch(const SearchParams& params) : params_(params) {}

  /// Matches from many start poses around the first of some guesses of T_target_base, and returns
  /// the best match that scores clearly more than `tracked`, the match from the first guess itself.
  /// A match far from all guesses needs a higher score.
  [[nodiscard]] std::optional<Match> find_better(const ScanMatcher& matcher, const PointMap& map,
                                                 std::span<const OrientedPoint> scan,
                                                 std::span<const geometry::SE2> guesses,
                                                 const Match& tracked) const;

  /// The most promising start poses, best first, all clearly different.
  [[nodiscard]] std::vector<geometry::SE2> candidates(const PointMap& map,
                                                      std::span<const OrientedPoint> scan,
                                                      std::span<const geometry::SE2> guesses) const;

 private:
  struct Candidate {
    double score = 0.0;  ///< less the cost
    geometry::SE2 T_target_base;
  };
  /// All start poses, with their scores.
  [[nodiscard]] std::vector<Candidate> poses_around(const PointMap& map,
                                                    std::span<const OrientedPoint> scan,
                                                    std::span<const geometry::SE2> guesses) const;
  [[nodiscard]] double cost(const geometry::SE2& pose,
                            std::span<const geometry::SE2> guesses) const;

  SearchParams params_;
};

}  // namespace nodmap::slam2d
