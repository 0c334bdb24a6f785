// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "modules/slam2d/back_end/submap.hpp"
#include "modules/slam2d/back_end/submap_graph.hpp"
#include "modules/slam2d/matching/correlative_match.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// The attempt to recognise a keyframe in a submap that does not hold it.
struct Loop {
  std::size_t submap = 0;
  std::size_t keyframe = 0;
  geometry::SE2 T_submap_keyframe = {};
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< in the frame of the submap
  double score = 0.0;  ///< of the match, 0..1; without a match it and the pose are zero
  LoopState state = LoopState::kLowScore;  ///< by the match: kAccepted, kAmbiguous or kLowScore
  bool is_contradicted = false;  ///< by what was seen: walls where the other saw free space
};

/// A keyframe, and the submap in which it may be recognised.
struct LoopQuery {
  std::size_t submap = 0;
  std::size_t keyframe = 0;
  std::span<const OrientedPoint> scan;  ///< of the keyframe, in base
};

/// One keyframe against one submap: finds its pose there with the information matrix. Also decides
/// which of several loops agree. SubmapLoops says which submaps are tried.
class LoopCloser {
 public:
  LoopCloser(const LoopParams& params, const MatcherParams& matcher);

  /// Matches from a pose that is known to be near.
  [[nodiscard]] Loop track(const LoopQuery& query, const Submap& submap,
                           const geometry::SE2& T_submap_base_guess) const;

  /// Finds the best match within a window. `grid`: that of the submap.
  [[nodiscard]] Loop search(const LoopQuery& query, const Submap& submap,
                            const LikelihoodGrid& grid, const SearchWindow& window) const;

  /// Keeps a loop that was found by a search. Through the present pose of its submap each loop
  /// gives a pose of the newest keyframe; loops that give the same pose agree on the drift. Returns
  /// the loops that agree with this one, and drops all others, once they come from
  /// `consensus.min_keyframes` keyframes; otherwise returns none. Each keyframe whose loop is
  /// contradicted raises the number needed by `min_keyframes`.
  [[nodiscard]] std::vector<Loop> add_pending(const Loop& loop, std::span<const Submap> submaps,
                                              std::span<const Keyframe> keyframes);

  /// Forgets a submap and the keyframes from `first_keyframe` to before `end_keyframe`. The indices
  /// of all after them move up.
  void drop_submap(std::size_t dropped, std::size_t first_keyframe, std::size_t end_keyframe);

 private:
  /// Accepts a match that fits, and is not far from the pose it started from.
  [[nodiscard]] Loop loop_of(const LoopQuery& query, const Match& match,
                             const geometry::SE2& T_submap_base_start,
                             double min_inlier_ratio) const;

  LoopParams params_;
  ScanMatcher matcher_;
  std::vector<Loop> pending_;
};

}  // namespace nodmap::slam2d
