// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "modules/slam2d/back_end/saved_map.hpp"
#include "modules/slam2d/back_end/submap.hpp"
#include "modules/slam2d/back_end/submap_chain.hpp"
#include "modules/slam2d/back_end/submap_graph.hpp"
#include "modules/slam2d/back_end/submap_grids.hpp"
#include "modules/slam2d/back_end/submap_loops.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// What the back end did, in counts.
struct BackEndMetrics : LoopMetrics {
  std::int64_t submaps_dropped = 0;  ///< newer ones have replaced them
};

/// Keeps the map consistent: submaps of consecutive keyframes, joined by odometry and by loops in a
/// pose graph.
///
/// The area bounds its memory, not the time: a submap, and the keyframes that no other submap
/// holds, are dropped once newer keyframes show the same places.
///
/// After each add_keyframe(), close_loops() and then apply_loops() must be called. In between scans
/// may be matched against the local submap: close_loops() may run on another thread, because it
/// changes nothing that the const functions and find_in_local() use.
class BackEnd {
 public:
  BackEnd(const BackEndParams& params, const MapParams& map, const MatcherParams& matcher);

  /// Everything that restore() needs.
  [[nodiscard]] SavedMap save() const;

  /// Restores a saved map. Must be called before the first keyframe, which then begins a submap of
  /// its own at its T_map_base, with assumed standard deviations of 0.1 m and 0.02 rad.
  void restore(SavedMap map);

  /// The next keyframe begins a submap of its own at its T_map_base. `sigmas`: standard deviations
  /// (x, y in m, yaw in rad) of its pose relative to the previous keyframe. The map up to there and
  /// the map from there on are two rigid pieces until loops join them.
  void begin_anew(const Eigen::Vector3d& sigmas) { chain_.begin_anew(sigmas); }

  /// Whether there is a submap to match scans against: once a keyframe was added.
  [[nodiscard]] bool has_local() const { return chain_.has_local(); }
  /// The submap that scans are matched against. Valid until the next keyframe is added, or loops
  /// are applied.
  [[nodiscard]] const Submap& local() const { return chain_.local(); }

  /// The covariance (x, y in m, yaw in rad, in the axes of map) of the local submap's pose relative
  /// to the first one: the drift since the map began that loops have not corrected.
  [[nodiscard]] const Eigen::Matrix3d& drift_covariance() const {
    return loops_.drift_covariance();
  }

  /// Searches the local submap for the poses at which a scan fits, at the resolution of a cell.
  /// `scan`: points in base; `window`: the poses to search, in the frame of the submap. Returns at
  /// most `max_places` poses, each with a mean likelihood of at least `min_score`.
  [[nodiscard]] CorrelativeMatch find_in_local(std::span<const OrientedPoint> scan,
                                               const SearchWindow& window, double min_score,
                                               std::size_t max_places);

  /// Adds a keyframe at its place in the local submap. `information`: inverse covariance of (x, y
  /// in m, yaw in rad) in the frame of the submap, from the match that found the place; zero
  /// without a match. Without a local submap the keyframe begins one at its T_map_base, and the
  /// other arguments are not used.
  void add_keyframe(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
                    const Eigen::Matrix3d& information);

  /// Finds loops between the newest keyframe and older submaps, and the poses of all submaps that
  /// agree best with them.
  void close_loops();

  /// Moves the submaps to where close_loops() has found that they belong, and drops one that newer
  /// keyframes replace.
  void apply_loops();

  /// What the last apply_loops() has dropped, if anything. The newest keyframes always stay.
  [[nodiscard]] const std::optional<DroppedKeyframes>& dropped() const { return dropped_; }

  /// Straightens the beginning of the map, then matches every keyframe anew against the submaps
  /// around it, and optimises all their poses.
  void polish();

  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return chain_.keyframes(); }
  [[nodiscard]] std::span<const Submap> submaps() const { return chain_.submaps(); }
  [[nodiscard]] BackEndMetrics metrics() const { return {loops_.metrics(), submaps_dropped_}; }
  /// One entry for each pair of submaps between which a loop was tried.
  [[nodiscard]] std::vector<SubmapLoop> loops() const { return loops_.graph().loops(submaps()); }
  /// Counts the changes of submaps and loops.
  [[nodiscard]] std::int64_t graph_revision() const {
    return loops_.graph().revision() + loops_.metrics().optimisations + num_rebuilt_;
  }
  [[nodiscard]] std::size_t num_points() const { return chain_.num_points(); }

 private:
  /// What close_loops() has found, until it is applied.
  struct ClosedLoops {
    SubmapLoops loops;
    std::optional<std::vector<geometry::SE2>> T_map_submaps;  // nothing: they stay
  };

  void drop_replaced_submap();

  BackEndParams params_;
  SubmapChain chain_;
  SubmapLoops loops_;
  // Only close_loops() uses these two until apply_loops().
  SubmapGrids grids_;
  std::optional<ClosedLoops> closed_;
  SubmapGrids local_grid_{1};
  std::optional<DroppedKeyframes> dropped_;
  bool may_be_replaced_ = false;  // a submap, since the newest keyframe
  std::int64_t submaps_dropped_ = 0;
  std::int64_t num_rebuilt_ = 0;  // how often polish() has made all submaps anew
};

}  // namespace nodmap::slam2d
