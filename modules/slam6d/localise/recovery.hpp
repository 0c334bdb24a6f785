// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/localise/localiser.hpp"
#include "modules/slam6d/metrics.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"
#include "modules/slam6d/tracking/corrected_poses.hpp"
#include "modules/slam6d/tracking/tracker.hpp"

namespace nodmap::slam6d {

/// Finds the robot while its place is unknown: in a saved map, or in its own map after it was LOST.
/// A wrong place would spoil the map, so the map is closed until the place is confirmed: nothing is
/// added to it.
class Recovery {
 public:
  /// The SLAM at the time of a sweep.
  struct Known {
    Tracker& tracker;
    const VoxelMap& map;
    std::span<const Keyframe> keyframes;
    std::int64_t graph_revision;  ///< changes with the keyframes
    CorrectedPoses& corrected;
    Metrics& counts;
  };

  explicit Recovery(const Slam6dParams& params) : params_(params) {}

  /// Begins in a saved map, which is closed until the robot has been found there. `is_fixed`: it
  /// stays closed. `T_map_start`: pose of the robot at the first sweep, if it is known.
  void begin_in_saved_map(const Known& saved, const std::optional<geometry::SE3>& T_map_start,
                          bool is_fixed);

  /// Continues with odometry in another frame; `T_old_new` is empty before the first odometry.
  void change_odometry_frame(const std::optional<geometry::SE3>& T_old_new);

  [[nodiscard]] bool is_map_closed() const { return is_map_closed_; }
  /// Whether the robot has a place in the map, confirmed or not.
  [[nodiscard]] bool has_place() const { return !is_map_closed_ || localiser_->has_place(); }
  /// Whether the next sweep may need a search for the robot, which takes longer. `lost_sweeps`:
  /// sweeps refused in a row until now.
  [[nodiscard]] bool may_search(int lost_sweeps) const {
    return is_map_closed_ ? !localiser_->has_place() : lost_sweeps > 0;
  }
  /// Empty until it is needed.
  [[nodiscard]] const std::optional<Localiser>& localiser() const { return localiser_; }

  /// To be called with each sweep that has scans, usable or not: a start pose is that of the first
  /// one. `T_first_base`: the pose at its first beam by odometry, in the first odom frame.
  void note_start(const geometry::SE3& T_first_base) {
    T_first_start_ = T_first_start_.value_or(T_first_base);
  }

  /// To be called while the robot has no place: tracking begins at the place of this sweep, if it
  /// is found. Otherwise there is no pose, and the sweep is LOST.
  void find_place(const Known& known, const VoxelMap& sweep, const SweepCloud& cloud,
                  PoseUpdate& update);

  /// To be called with each sweep that was tracked. Doubts its pose after LOST, searches the map
  /// after several LOST sweeps, and confirms or takes back the place that was found. `lost_before`:
  /// sweeps refused in a row before this one. Returns whether the robot was found by a search: its
  /// motion since the last keyframe is then unknown.
  [[nodiscard]] bool check_place(const Known& known, int lost_before, VoxelMap& sweep,
                                 SweepCloud& cloud, PoseUpdate& update);

 private:
  void classify_place(const Known& known, const VoxelMap& sweep, const SweepCloud& cloud,
                      PoseUpdate& update);
  [[nodiscard]] bool recover(const Known& known, VoxelMap& sweep, SweepCloud& cloud,
                             PoseUpdate& update);
  [[nodiscard]] Localiser& localiser_in_own_map(const Known& known);
  [[nodiscard]] bool search_own_map(const Known& known, VoxelMap& sweep, SweepCloud& cloud,
                                    PoseUpdate& update);
  void take_back_place(const Known& known, const SweepCloud& cloud, PoseUpdate& update);

  Slam6dParams params_;
  std::optional<Localiser> localiser_;   // in a saved map, or in the own one after LOST
  std::int64_t localiser_revision_ = 0;  // of the graph from which it was made
  bool is_map_fixed_ = false;
  bool is_map_closed_ = false;  // never true without localiser_
  std::optional<geometry::SE3> T_first_start_;
  /// Follows odometry from where the robot was lost, until the place that was found instead is
  /// confirmed.
  std::optional<Tracker> by_odometry_;
  std::size_t first_at_place_ = 0;  // the sweep with which that place was found
};

}  // namespace nodmap::slam6d
