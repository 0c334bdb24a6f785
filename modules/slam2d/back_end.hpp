// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/registration/pose_graph.hpp"
#include "modules/slam2d/loop_closer.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/saved_map.hpp"
#include "modules/slam2d/scan_matcher.hpp"
#include "modules/slam2d/submap.hpp"
#include "modules/slam2d/submap_graph.hpp"

namespace nodmap::slam2d {

/// What the back end did, for the one line at the end.
struct BackEndMetrics {
  std::int64_t loops_tracked = 0;   ///< found by a match from the pose of the graph
  std::int64_t loops_searched = 0;  ///< accepted by consensus
  std::int64_t searches = 0;
  std::int64_t refused_ambiguous = 0;
  std::int64_t refused_match = 0;
  std::int64_t refused_by_graph = 0;  ///< contradicts the pose of the graph
  std::int64_t optimisations = 0;
  std::int64_t submaps_dropped = 0;  ///< newer ones have replaced them
};

/// What became of the loops between two submaps: of the one that was accepted last or, if none was,
/// of the last one.
struct SubmapLoop {
  std::size_t from = 0;  ///< submaps
  std::size_t to = 0;
  LoopState state = LoopState::kLowScore;
  double score = 0.0;
};

/// Keyframes in a row that newer ones have replaced.
struct DroppedKeyframes {
  std::size_t first = 0;  ///< index before they were dropped; those after them have moved up
  std::vector<Keyframe> keyframes;
};

/// Keeps the map consistent: submaps of consecutive keyframes, joined by odometry and by loops in a
/// pose graph.
///
/// Two submaps grow at a time, each begun when the other is half full, so that there is always one
/// with enough in it to match against (Hess et al. 2016, section IV).
///
/// A robot that drives in the same place day after day does not need more and more of them: old
/// submaps are dropped, and their keyframes with them, once newer ones show the same.
class BackEnd {
 public:
  BackEnd(const BackEndParams& params, const MapParams& map, const MatcherParams& matcher);

  /// Everything that restore() needs.
  [[nodiscard]] SavedMap save() const;

  /// Takes over a saved map; to be called before the first keyframe. The next keyframe begins a
  /// submap of its own at its T_map_base, which is taken as known to a few centimetres.
  void restore(SavedMap map);

  /// The next keyframe begins a submap of its own at its T_map_base, which relative to the keyframe
  /// before is known to `sigmas` (x, y in m, yaw in rad): what the robot saw until now and what it
  /// sees from now on move as two rigid pieces, until loops join them.
  void begin_anew(const Eigen::Vector3d& sigmas);

  /// Whether there is a submap to match scans against: once a keyframe was added.
  [[nodiscard]] bool has_local() const { return local_ < submaps_.size(); }
  /// The submap that scans are matched against. Valid until the next keyframe is added.
  [[nodiscard]] const Submap& local() const { return submaps_[local_]; }

  /// The covariance (x, y in m, yaw in rad, in the axes of map) of the local submap's pose relative
  /// to the first one: the drift since the map began, as far as loops have not taken it back.
  [[nodiscard]] const Eigen::Matrix3d& drift_covariance() const { return drift_covariance_; }

  /// Where a scan lies in the local submap, by a search of all poses within `window`, in the frame
  /// of the submap, to the cell; nothing where it fits several places, or none with a mean
  /// likelihood of `min_score`.
  [[nodiscard]] std::optional<geometry::SE2> find_in_local(std::span<const OrientedPoint> scan,
                                                           const SearchWindow& window,
                                                           double min_score);

  /// Adds a keyframe at its place in the local submap, closes loops with older submaps, and moves
  /// all submaps if that changed anything. `information` (x, y, yaw in the frame of the submap): of
  /// the match that found the place, zero where there was none. Without a local submap the keyframe
  /// begins one at its T_map_base, and the other arguments are not used.
  void add_keyframe(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
                    const Eigen::Matrix3d& information);

  /// What the last add_keyframe() has dropped, if anything. The newest keyframes always stay.
  [[nodiscard]] const std::optional<DroppedKeyframes>& dropped() const { return dropped_; }

  /// Matches every keyframe anew against the submaps around it, and optimises all their poses.
  void polish();

  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] std::span<const Submap> submaps() const { return submaps_; }
  [[nodiscard]] const BackEndMetrics& metrics() const { return metrics_; }
  /// By the submaps they join.
  [[nodiscard]] std::vector<SubmapLoop> loops() const;
  /// Counts the changes of submaps and loops.
  [[nodiscard]] std::int64_t graph_revision() const { return graph_revision_; }
  [[nodiscard]] std::size_t num_points() const;

 private:
  [[nodiscard]] bool is_full(const Submap& submap, double ratio) const;
  void begin_local();
  [[nodiscard]] Submap build_submap(std::size_t first_keyframe, std::size_t end_keyframe) const;
  void insert_into_submaps(const geometry::SE2& T_local_keyframe);
  void add_chain_edge(std::size_t keyframe, const geometry::SE2& T_last_keyframe,
                      const Eigen::Matrix3d& information);
  [[nodiscard]] registration::PoseEdge2d chain_of_submaps(std::size_t submap) const;

  /// The submaps before it are finished: loops are closed with them.
  [[nodiscard]] std::size_t end_finished() const;
  void close_loops();
  void track_loop(std::size_t submap_index, std::span<const OrientedPoint> scan);
  void search_loop(std::size_t submap_index, std::span<const OrientedPoint> scan, double reach_m,
                   double reach_rad);
  void accept_by_consensus(const Loop& loop);
  void accept(const Loop& loop);
  void record(const Loop& loop, LoopState state);
  void drop_replaced_submap();
  void drop_submap(std::size_t dropped);
  [[nodiscard]] DroppedKeyframes drop_keyframes(std::size_t first, std::size_t end);
  void drop_from_loops(std::size_t dropped);
  void optimise();
  void move_keyframes();
  void rebuild_submaps();

  BackEndParams params_;
  MapParams map_params_;
  LoopCloser closer_;
  std::vector<Keyframe> keyframes_;
  std::vector<std::size_t> submap_of_;  ///< the one each keyframe was matched against
  std::vector<Submap> submaps_;
  std::size_t local_ = 0;
  std::size_t num_separate_ = 0;  ///< submaps before the last begin_anew()
  /// Of a submap that begins anew relative to the keyframe before: x, y in m, yaw in rad.
  Eigen::Vector3d begin_sigmas_ = Eigen::Vector3d::Zero();
  std::vector<registration::PoseEdge2d> chain_;  ///< from keyframe k to k + 1
  SubmapGraph graph_;
  std::optional<DroppedKeyframes> dropped_;
  std::size_t keyframes_since_optimised_ = 0;
  bool has_new_loops_ = false;
  bool has_searched_loops_ = false;
  std::vector<Eigen::Matrix3d> uncertainty_;                    ///< as it was at the last search
  Eigen::Matrix3d drift_covariance_ = Eigen::Matrix3d::Zero();  ///< likewise
  std::map<std::pair<std::size_t, std::size_t>, SubmapLoop> loops_;
  std::int64_t graph_revision_ = 0;
  BackEndMetrics metrics_;
};

}  // namespace nodmap::slam2d
