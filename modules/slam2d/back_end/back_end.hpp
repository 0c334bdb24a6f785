// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "modules/slam2d/back_end/loop_closer.hpp"
#include "modules/slam2d/back_end/saved_map.hpp"
#include "modules/slam2d/back_end/submap.hpp"
#include "modules/slam2d/back_end/submap_chain.hpp"
#include "modules/slam2d/back_end/submap_graph.hpp"
#include "modules/slam2d/back_end/submap_grids.hpp"
#include "modules/slam2d/back_end/variance_factor.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// What the back end did, in counts.
struct BackEndMetrics {
  std::int64_t loops_tracked = 0;   ///< found by a match from the pose of the graph
  std::int64_t loops_searched = 0;  ///< accepted by consensus
  std::int64_t searches = 0;
  std::int64_t refused_ambiguous = 0;
  std::int64_t refused_match = 0;
  std::int64_t refused_by_graph = 0;  ///< contradicts the pose of the graph
  std::int64_t refused_by_view = 0;   ///< walls where the other saw free space
  std::int64_t optimisations = 0;
  std::int64_t submaps_dropped = 0;  ///< newer ones have replaced them
};

/// Keeps the map consistent: submaps of consecutive keyframes, joined by odometry and by loops in a
/// pose graph.
///
/// The area bounds its memory, not the time: a submap, and the keyframes that no other submap
/// holds, are dropped once newer keyframes show the same places.
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
  /// The submap that scans are matched against. Valid until the next keyframe is added.
  [[nodiscard]] const Submap& local() const { return chain_.local(); }

  /// The covariance (x, y in m, yaw in rad, in the axes of map) of the local submap's pose relative
  /// to the first one: the drift since the map began that loops have not corrected.
  [[nodiscard]] const Eigen::Matrix3d& drift_covariance() const { return drift_covariance_; }

  /// Searches the local submap for the poses at which a scan fits, at the resolution of a cell.
  /// `scan`: points in base; `window`: the poses to search, in the frame of the submap. Returns at
  /// most `max_places` poses, each with a mean likelihood of at least `min_score`.
  [[nodiscard]] CorrelativeMatch find_in_local(std::span<const OrientedPoint> scan,
                                               const SearchWindow& window, double min_score,
                                               std::size_t max_places);

  /// Adds a keyframe at its place in the local submap, closes loops with older submaps, and moves
  /// all submaps if that changed anything. `information`: inverse covariance of (x, y in m, yaw in
  /// rad) in the frame of the submap, from the match that found the place; zero without a match.
  /// Without a local submap the keyframe begins one at its T_map_base, and the other arguments are
  /// not used.
  void add_keyframe(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
                    const Eigen::Matrix3d& information);

  /// What the last add_keyframe() has dropped, if anything. The newest keyframes always stay.
  [[nodiscard]] const std::optional<DroppedKeyframes>& dropped() const { return dropped_; }

  /// Straightens the beginning of the map, then matches every keyframe anew against the submaps
  /// around it, and optimises all their poses.
  void polish();

  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return chain_.keyframes(); }
  [[nodiscard]] std::span<const Submap> submaps() const { return chain_.submaps(); }
  [[nodiscard]] const BackEndMetrics& metrics() const { return metrics_; }
  /// One entry for each pair of submaps between which a loop was tried.
  [[nodiscard]] std::vector<SubmapLoop> loops() const { return graph_.loops(submaps()); }
  /// Counts the changes of submaps and loops.
  [[nodiscard]] std::int64_t graph_revision() const { return graph_.revision() + num_rebuilt_; }
  [[nodiscard]] std::size_t num_points() const { return chain_.num_points(); }

 private:
  void close_loops();
  void update_uncertainty();
  void optimise_if_due();
  [[nodiscard]] Loop track_loop(std::size_t submap, std::span<const OrientedPoint> scan);
  [[nodiscard]] Loop search_loop(std::size_t submap, std::span<const OrientedPoint> scan,
                                 double reach_m, double reach_rad);
  void decide(const Loop& loop, bool was_searched);
  void accept_by_consensus(Loop loop);
  void accept(const Loop& loop);
  void record_try(const Loop& loop, LoopState state);
  [[nodiscard]] double chi_squared(const Loop& loop) const;
  [[nodiscard]] bool contradicts_views(const Loop& loop) const;
  void drop_replaced_submap();
  void drop_submap(std::size_t dropped);
  void optimise();

  BackEndParams params_;
  SubmapChain chain_;
  LoopCloser closer_;
  SubmapGrids grids_;
  SubmapGraph graph_;
  std::optional<DroppedKeyframes> dropped_;
  std::size_t keyframes_since_optimised_ = 0;
  bool has_new_loops_ = false;
  bool has_searched_loops_ = false;
  std::int64_t num_rebuilt_ = 0;              ///< how often polish() has made all submaps anew
  std::vector<Eigen::Matrix3d> uncertainty_;  ///< of each submap relative to the local one
  double uncertainty_factor_ = 1.0;           ///< the variance factor in it
  Eigen::Matrix3d drift_covariance_ = Eigen::Matrix3d::Zero();
  BackEndMetrics metrics_;
};

}  // namespace nodmap::slam2d
