// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/keyframe_graph.hpp"
#include "modules/slam6d/loop_closer.hpp"
#include "modules/slam6d/odometry_prior.hpp"
#include "modules/slam6d/saved_map.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// What the back end did, for the one line at the end.
struct BackEndMetrics {
  std::int64_t loops_tracked = 0;   ///< found by a match from the pose of the graph
  std::int64_t loops_searched = 0;  ///< accepted by consensus
  std::int64_t searches = 0;
  std::int64_t refused_ambiguous = 0;
  std::int64_t refused_match = 0;
  std::int64_t corrections = 0;
  std::int64_t maps_arranged = 0;
  double largest_correction_m = 0.0;  ///< of the newest keyframe
};

/// A keyframe as tracking found it.
struct TrackedKeyframe {
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  /// Of position (m) and rotation vector (rad), axes of map; zero where nothing was matched.
  Matrix6d information = Matrix6d::Zero();
  bool follows_interruption = false;
  double odometry_scatter = 1.0;  ///< OdometryScatter's factor
  bool is_level = false;          ///< wheels on level ground, as far as the match shows
};

/// A place of before in which a keyframe was looked for without being joined to it.
struct RefusedLoop {
  std::size_t from = 0;  ///< keyframe of the place
  std::size_t to = 0;    ///< the one that was looked for
  LoopRefusal reason = LoopRefusal::kLowScore;
};

/// Keeps the map consistent: keyframes joined by odometry, matches and loop closures in a pose
/// graph.
///
/// Sweeps are registered against what is certain relative to the robot. A place of before whose
/// relative pose has become uncertain is moved to the old map; a keyframe that is recognised there
/// closes a loop. The correction is distributed over the whole way between, and the voxels, each of
/// which belongs to a keyframe, move along. So no wall is entered twice.
class BackEnd {
 public:
  BackEnd(const LoopParams& loops, const RegistrationParams& registration,
          const OdometryParams& odometry, const VoxelMapParams& voxels);

  /// Takes over the keyframes of a saved map, before the first one is added. That is joined to the
  /// nearest of them by its match with the map.
  void restore(const SavedMap& saved);

  /// Adds a keyframe whose sweep is in `map` already, and looks for it in the old map. Returns the
  /// poses of all keyframes if they have moved. The voxels of `map` move along, and are exchanged
  /// with those of the old map.
  [[nodiscard]] std::optional<std::vector<geometry::SE3>> add_keyframe(
      const TrackedKeyframe& keyframe, const VoxelMap& sweep_base, VoxelMap& map);

  /// Moves the newest keyframes, too, to where they agree best with all loops: at the end. Returns
  /// the poses of all keyframes; the voxels stay.
  [[nodiscard]] std::vector<geometry::SE3> polish();

  /// Whether a place of before was recognised.
  [[nodiscard]] bool has_loops() const {
    return metrics_.loops_tracked + metrics_.loops_searched > 0;
  }
  [[nodiscard]] const BackEndMetrics& metrics() const { return metrics_; }
  [[nodiscard]] const KeyframeGraph& graph() const { return graph_; }
  [[nodiscard]] std::span<const geometry::SE3> T_map_keyframes() const { return T_map_keyframes_; }
  [[nodiscard]] std::span<const RefusedLoop> refused_loops() const { return refused_; }
  /// Counts the changes of keyframes and loops.
  [[nodiscard]] std::int64_t graph_revision() const { return graph_revision_; }
  [[nodiscard]] const VoxelMap& old_map() const { return old_map_; }

 private:
  [[nodiscard]] std::size_t newest() const { return T_map_keyframes_.size() - 1; }
  void add_step(const TrackedKeyframe& keyframe);
  void join_to_restored(const TrackedKeyframe& keyframe);
  void add_loop(const Loop& loop);
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
  std::vector<double> path_m_;         // driven until each keyframe
  std::vector<Matrix6d> uncertainty_;  // relative to the newest one, axes of map
  std::vector<bool> is_in_map_;        // not in the old one
  std::size_t num_restored_ = 0;       // the first keyframes
  std::vector<RefusedLoop> refused_;
  bool has_searched_loops_ = false;  // since the last optimisation
  std::int64_t graph_revision_ = 0;
  BackEndMetrics metrics_;
};

}  // namespace nodmap::slam6d
