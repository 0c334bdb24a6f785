// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/back_end/keyframe_graph.hpp"
#include "modules/slam6d/back_end/loop_closer.hpp"
#include "modules/slam6d/back_end/saved_map.hpp"
#include "modules/slam6d/model/replaced_keyframe.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/tracking/odometry_prior.hpp"

namespace nodmap::slam6d {

/// What the back end did, in counts.
struct BackEndMetrics {
  std::int64_t loops_tracked = 0;   ///< found by a match from the pose of the graph
  std::int64_t loops_searched = 0;  ///< accepted by consensus
  std::int64_t searches = 0;
  std::int64_t refused_ambiguous = 0;
  std::int64_t refused_match = 0;
  std::int64_t corrections = 0;
  std::int64_t maps_arranged = 0;
  double largest_correction_m = 0.0;   ///< of the newest keyframe
  std::int64_t keyframes_dropped = 0;  ///< newer ones have replaced them
};

/// A keyframe as tracking found it.
struct TrackedKeyframe {
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  /// Inverse covariance of position (m) and rotation vector (rad) in the axes of map; zero without
  /// a match.
  Matrix6d information = Matrix6d::Zero();
  bool follows_interruption = false;
  double odometry_scatter = 1.0;  ///< OdometryScatter::factor()
  bool is_level = false;          ///< wheels on level ground, as far as the match shows
};

/// An attempt to recognise a keyframe at an earlier place that gave no loop.
struct RefusedLoop {
  std::size_t from = 0;  ///< keyframe of the place
  std::size_t to = 0;    ///< keyframe that was to be recognised
  LoopRefusal reason = LoopRefusal::kLowScore;
};

/// Keeps the map consistent: keyframes joined by odometry, matches and loop closures in a pose
/// graph.
///
/// Sweeps are registered against the part of the map that is certain relative to the robot. Earlier
/// places whose relative pose has become uncertain are moved to the old map; a keyframe that is
/// recognised there closes a loop. The correction is distributed over the whole path in between.
/// Each voxel belongs to a keyframe and moves with it. Thus no wall is entered twice.
class BackEnd {
 public:
  BackEnd(const LoopParams& loops, const RegistrationParams& registration,
          const OdometryParams& odometry, const VoxelMapParams& voxels);

  /// Restores the keyframes of a saved map. Must be called before the first keyframe is added. That
  /// keyframe is joined to the nearest restored one by its match with the map.
  void restore(const SavedMap& saved);

  /// Takes over poses that were adjusted to more than the graph contains. The steps agree with them
  /// from now on, so that they last where the map is continued.
  void take_adjusted(std::span<const geometry::SE3> T_map_keyframes);

  /// The keyframes, which are those of its graph, and how they are joined.
  [[nodiscard]] SavedMap save(std::span<const Keyframe> keyframes) const;

  /// Adds a keyframe whose sweep is already in `map`, and searches for it in the old map. Returns
  /// the poses of all keyframes if they have moved. Then the voxels of `map` have moved with them,
  /// and voxels have been exchanged with the old map.
  [[nodiscard]] std::optional<std::vector<geometry::SE3>> add_keyframe(
      const TrackedKeyframe& keyframe, const VoxelMap& sweep_base, VoxelMap& map);

  /// The oldest keyframe at the place of the newest that at least `num_newer` newer ones have
  /// replaced.
  [[nodiscard]] std::optional<ReplacedKeyframe> replaced_keyframe(int num_newer) const {
    return oldest_replaced_keyframe(T_map_keyframes_, is_in_map_, num_newer);
  }
  /// Drops a keyframe; the indices of those after it move up. Its voxels in `map` go to the
  /// keyframe that replaces it, its loops to others near it.
  void drop_keyframe(const ReplacedKeyframe& replaced, VoxelMap& map);

  /// To be called at the end. Moves all keyframes, including the newest, to where they agree best
  /// with all loops, and returns their poses. The voxels stay.
  [[nodiscard]] std::vector<geometry::SE3> polish();

  /// Whether an earlier place was recognised.
  [[nodiscard]] bool has_loops() const {
    return metrics_.loops_tracked + metrics_.loops_searched > 0;
  }
  [[nodiscard]] const BackEndMetrics& metrics() const { return metrics_; }
  [[nodiscard]] const KeyframeGraph& graph() const { return graph_; }
  [[nodiscard]] std::span<const geometry::SE3> T_map_keyframes() const { return T_map_keyframes_; }
  [[nodiscard]] std::span<const RefusedLoop> refused_loops() const { return refused_; }
  /// Counts the changes of keyframes and loops.
  [[nodiscard]] std::int64_t graph_revision() const { return graph_revision_; }
  /// To be called at first if this replaces a back end, with its graph_revision().
  void count_revisions_from(std::int64_t graph_revision) { graph_revision_ = graph_revision; }

 private:
  [[nodiscard]] std::size_t newest() const { return T_map_keyframes_.size() - 1; }
  void add_step(const TrackedKeyframe& keyframe);
  void join_to_restored(const TrackedKeyframe& keyframe);
  void add_loop(const Loop& loop, std::optional<double> weight = std::nullopt);
  /// The poses of all keyframes that fit all edges best.
  [[nodiscard]] std::vector<geometry::SE3> optimise();
  void tie_to_map(const TrackedKeyframe& keyframe);
  [[nodiscard]] bool close_loops(const VoxelMap& sweep_base);
  [[nodiscard]] PosePrior prior_from(std::size_t old) const;
  [[nodiscard]] LoopAttempt match_with_old_map(const VoxelMap& sweep_base, std::size_t old,
                                               const PosePrior& prior) const;
  void refuse(std::size_t old, LoopRefusal reason);
  [[nodiscard]] std::vector<Loop> confirm(const Loop& loop);
  [[nodiscard]] bool correct(std::span<const geometry::SE3> T_map_moved, VoxelMap& map);
  [[nodiscard]] std::optional<std::size_t> nearest_keyframe(bool is_old) const;
  [[nodiscard]] std::vector<bool> certain_keyframes() const;
  [[nodiscard]] bool is_outdated(const std::vector<bool>& certain) const;
  void arrange(VoxelMap& map, std::span<const geometry::SE3> T_map_moved,
               std::vector<bool> certain);

  LoopParams params_;
  OdometryParams odometry_;
  VoxelMapParams voxels_;
  LoopCloser closer_;
  KeyframeGraph graph_;
  VoxelMap old_map_;
  std::vector<geometry::SE3> T_map_keyframes_;
  std::vector<double> path_m_;         // length of the path up to each keyframe
  std::vector<Matrix6d> uncertainty_;  // of each keyframe relative to the newest, axes of map
  std::vector<bool> is_in_map_;        // each keyframe: in the map, not in the old map
  std::size_t num_restored_ = 0;       // the first keyframes
  std::vector<RefusedLoop> refused_;
  bool has_searched_loops_ = false;  // since the last optimisation
  std::int64_t graph_revision_ = 0;
  BackEndMetrics metrics_;
};

}  // namespace nodmap::slam6d
