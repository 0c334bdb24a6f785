// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam6d/back_end/back_end.hpp"
#include "modules/slam6d/back_end/dropped_keyframes.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/back_end/saved_map.hpp"
#include "modules/slam6d/localise/localiser.hpp"
#include "modules/slam6d/localise/recovery.hpp"
#include "modules/slam6d/metrics.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/occupancy/ever_free_space.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/sweep/mount_error.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"
#include "modules/slam6d/sweep/sweep_collector.hpp"
#include "modules/slam6d/tracking/corrected_poses.hpp"
#include "modules/slam6d/tracking/first_sweeps.hpp"
#include "modules/slam6d/tracking/mount_estimate.hpp"
#include "modules/slam6d/tracking/tracker.hpp"

namespace nodmap::slam6d {

/// 6D SLAM, the paper's 6DOF SLAM (section IV B): scans and odometry in, poses and registered
/// clouds out.
class Slam6d {
 public:
  explicit Slam6d(const Slam6dParams& params);

  /// Restores a saved map; must be called before the first scan. `T_map_start`: pose of the robot
  /// at the first sweep; without it the robot is searched for. `is_fixed`: the robot is localised
  /// in the map, which is never changed; otherwise the map is continued as soon as the place is
  /// confirmed.
  void restore(const SavedMap& saved, const std::optional<geometry::SE3>& T_map_start,
               bool is_fixed);
  /// Everything that restore() needs.
  [[nodiscard]] SavedMap save() const { return back_end_.save(keyframes_); }
  /// Localises the robot in a saved map, or in its own map after it was lost. Empty before it is
  /// needed.
  [[nodiscard]] const std::optional<Localiser>& localiser() const { return recovery_.localiser(); }
  /// Whether the next sweep may need a search for the robot, which takes longer.
  [[nodiscard]] bool may_search() const { return recovery_.may_search(tracker_.lost_sweeps()); }

  /// Adds a pose of the robot by odometry. Returns false, and ignores it, if it is not finite.
  bool add_odometry(time::Timestamp stamp, const geometry::SE3& T_odom_base) {
    return collector_.add_odometry(stamp, T_odom_base);
  }

  /// Continues with odometry in another frame. The newest pose in the old frame and
  /// `T_new_odom_base` are taken as the same place, so the robot stays where it was in the map. The
  /// running sweep ends; its update is returned, after those of sweeps that waited for odometry.
  /// Older odometry is forgotten, so that no beam is placed between the frames. The next sweep is
  /// registered as after an interruption.
  [[nodiscard]] std::vector<PoseUpdate> change_odometry_frame(const geometry::SE3& T_new_odom_base);

  /// Adds the next scan of the stream, which must be plausible (scan::is_plausible()). Returns the
  /// pose of the sweep that it completes, if it completes one and there was odometry for it. If
  /// odometry comes late, the sweep waits, and a later scan returns its pose.
  [[nodiscard]] std::optional<PoseUpdate> add_scan(scan::Scan scan);

  /// At the end of the stream registers the next of the sweeps that wait for odometry, at last the
  /// unfinished one. Empty once none is left.
  [[nodiscard]] std::optional<PoseUpdate> flush();

  /// add_scan() and flush() in two steps: collecting the scans of a sweep, which takes
  /// microseconds, and registering it. The two steps may run on different threads: collect(),
  /// collect_rest(), add_odometry() and scan_counts() share no data with add_sweep(), add_cloud()
  /// and what they change.
  [[nodiscard]] std::optional<PlacedSweep> collect(scan::Scan scan) {
    return collector_.add_scan(std::move(scan));
  }
  [[nodiscard]] std::optional<PlacedSweep> collect_rest() { return collector_.flush(); }
  PoseUpdate add_sweep(const PlacedSweep& sweep);

  /// The same for a cloud that is deskewed already.
  PoseUpdate add_cloud(SweepCloud cloud);

  /// Where the robot was at each sweep. During a drive of days some sweeps are left out.
  [[nodiscard]] std::span<const SweepPose> sweeps() const { return corrected_.sweeps(); }
  [[nodiscard]] std::size_t num_sweeps() const { return corrected_.num_added(); }
  [[nodiscard]] std::span<const Keyframe> keyframes() const { return keyframes_; }
  /// The number of keyframes that come from a saved map. They are the first ones.
  [[nodiscard]] std::size_t num_restored() const { return num_restored_; }
  [[nodiscard]] const VoxelMap& map() const { return map_; }
  [[nodiscard]] const OdometryCalibration& calibration() const { return tracker_.calibration(); }
  [[nodiscard]] double pitch_latency_s() const { return tracker_.pitch_latency_s(); }
  /// How the laser is mounted other than described, as the floor shows it, and what is corrected.
  [[nodiscard]] const MountEstimate& mount() const { return mount_; }
  [[nodiscard]] const MountError& corrected_mount() const { return tracker_.mount(); }
  [[nodiscard]] const ScanCounts& scan_counts() const { return collector_.counts(); }
  [[nodiscard]] Metrics metrics() const;

  /// The pose of each of sweeps(), as known now: tracked sweeps as registered and moved with their
  /// keyframes, those in between with an interpolated correction.
  [[nodiscard]] std::vector<geometry::SE3> trajectory() const { return corrected_.trajectory(); }

  /// To be called at the end. Moves all poses, including the newest, to where they agree best with
  /// all loops. Then moves all keyframes and the sweeps in between together to where their planes
  /// agree best. The voxels stay. Finds again, for all keyframes, which of their points moved.
  void polish();
  [[nodiscard]] const BackEnd& back_end() const { return back_end_; }

 private:
  [[nodiscard]] bool is_usable(const PoseUpdate& update) const {
    return update.num_points > 0 &&
           update.scans_used >= static_cast<std::size_t>(params_.sweep.min_scans) &&
           (update.is_stationary || !params_.keyframe.stationary_only);
  }
  void learn_pitch_latency_at_start(const PlacedSweep& sweep);
  [[nodiscard]] bool is_better_beginning(const VoxelMap& sweep) const;
  void begin_anew();
  void forget_map();
  PoseUpdate repeat_first_sweeps();
  PoseUpdate register_sweep(const PlacedSweep& sweep);
  [[nodiscard]] Recovery::Known known() {
    return {tracker_, map_, keyframes_, back_end_.graph_revision(), corrected_, counts_};
  }
  [[nodiscard]] PoseUpdate follow_odometry(const SweepCloud& cloud);
  [[nodiscard]] std::optional<VoxelMap> voxels_to_register(const SweepCloud& cloud,
                                                           const PoseUpdate& update) const;
  void track(VoxelMap& sweep, SweepCloud& cloud, PoseUpdate& update);
  void add_to_map(const VoxelMap& sweep, const SweepCloud& cloud, const PoseUpdate& update);
  [[nodiscard]] bool is_adjusted(const PoseUpdate& update) const;
  [[nodiscard]] std::optional<KeyframeReason> keyframe_reason(const PoseUpdate& update) const;
  void record(const PoseUpdate& update);
  void add_keyframe(const VoxelMap& sweep, SweepCloud cloud, const PoseUpdate& update);
  void close_loops(const VoxelMap& sweep, PoseUpdate& update);
  void move_keyframes(std::span<const geometry::SE3> T_map_keyframes);
  void drop_replaced_keyframes();
  void adjust();
  void find_moved_points();

  Slam6dParams params_;
  SweepCollector collector_;
  Tracker tracker_;
  MountEstimate mount_;
  FirstSweeps first_sweeps_;
  VoxelMap map_;
  EverFreeSpace ever_free_;
  /// The motion since the last keyframe is unknown: there was an interruption, odometry began a new
  /// frame, or the place was found by a search.
  bool keyframe_is_due_ = false;
  CorrectedPoses corrected_;
  std::vector<Keyframe> keyframes_;
  std::vector<IntermediateSweep> between_;  // for the adjustment at the end
  DroppedKeyframes dropped_;
  BackEnd back_end_;
  Recovery recovery_;
  std::size_t num_restored_ = 0;  // the first keyframes
  Metrics counts_;
};

}  // namespace nodmap::slam6d
