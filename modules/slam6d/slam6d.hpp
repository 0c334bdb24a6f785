// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/pose_history.hpp"
#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam6d/back_end.hpp"
#include "modules/slam6d/corrected_poses.hpp"
#include "modules/slam6d/keyframe.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/registration.hpp"
#include "modules/slam6d/sweep_cloud.hpp"
#include "modules/slam6d/sweep_segmenter.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// The scans of complete sweeps.
struct ScanCounts {
  std::size_t in_sweeps = 0;
  std::size_t without_pose = 0;  ///< among them, left out
};

/// Counts of everything so far.
struct Metrics {
  std::size_t sweeps_tracked = 0;
  std::size_t sweeps_degraded = 0;
  std::size_t sweeps_lost = 0;
  std::size_t map_voxels = 0;
  std::size_t map_memory_bytes = 0;
};

/// 6DOF-SLAM of section IV B: scans and odometry in, poses and registered clouds out.
class Slam6d {
 public:
  explicit Slam6d(const Slam6dParams& params);

  /// The robot's pose by odometry; returns whether it was taken (finite).
  bool add_odometry(std::int64_t utime_us, const geometry::SE3& T_odom_base);

  /// Odometry goes on in another frame: its newest pose and `T_new_odom_base` are one place, as far
  /// as anybody knows, and the robot stays where it was in the map. The running sweep ends, and its
  /// update is returned; odometry is forgotten, so that no beam is placed between the frames; the
  /// next sweep is registered as after an interruption.
  [[nodiscard]] std::optional<PoseUpdate> change_odometry_frame(
      const geometry::SE3& T_new_odom_base);

  /// The next scan of the stream. Returns the pose of the sweep it completes, if it does, and if
  /// there was odometry for it. The scan must be plausible (scan::is_plausible).
  [[nodiscard]] std::optional<PoseUpdate> add_scan(scan::Scan scan);

  /// The unfinished sweep at the end of the stream.
  [[nodiscard]] std::optional<PoseUpdate> flush();

  /// What add_scan() and flush() do, in two steps: to collect the scans of a sweep, which takes
  /// microseconds, and to register it. collect(), collect_rest(), add_odometry() and scan_counts()
  /// share nothing with add_sweep(), add_cloud() and what they change.
  [[nodiscard]] std::optional<PlacedSweep> collect(scan::Scan scan);
  [[nodiscard]] std::optional<PlacedSweep> collect_rest();
  PoseUpdate add_sweep(const PlacedSweep& sweep);

  /// The same for a cloud that is one already: everything after deskewing.
  PoseUpdate add_cloud(SweepCloud cloud);

  [[nodiscard]] std::span<const PoseUpdate> sweeps() const { return sweeps_; }
  [[nodiscard]] std::span<const Keyframe> keyframes() const { return keyframes_; }
  [[nodiscard]] const VoxelMap& map() const { return map_; }
  [[nodiscard]] const OdometryCalibration& calibration() const { return calibration_; }
  [[nodiscard]] double pitch_latency_s() const { return pitch_latency_.seconds(); }
  [[nodiscard]] const ScanCounts& scan_counts() const { return scan_counts_; }
  [[nodiscard]] Metrics metrics() const;

  /// The pose of every sweep, with all that is known now: tracked sweeps as registered and moved
  /// with their keyframes, those between two of them with a correction that goes over evenly from
  /// one to the next.
  [[nodiscard]] std::vector<geometry::SE3> trajectory() const {
    return corrected_.trajectory(sweeps_);
  }

  /// Moves the newest poses, too, to where they agree best with all loops: at the end.
  void polish();
  [[nodiscard]] const BackEnd& back_end() const { return back_end_; }

 private:
  [[nodiscard]] std::optional<PlacedSweep> place_sweep(Sweep sweep);
  [[nodiscard]] bool is_better_beginning(const VoxelMap& sweep) const;
  void begin_anew(PoseUpdate& update);
  [[nodiscard]] PoseUpdate extrapolate(const SweepCloud& cloud) const;
  [[nodiscard]] bool is_usable(const PoseUpdate& update) const;
  [[nodiscard]] OdometryMotion motion_since_accepted(const SweepCloud& cloud) const;
  [[nodiscard]] geometry::SE3 counted_since_accepted(const geometry::SE3& T_odom_base) const;
  void calibrate(const SweepCloud& cloud, const PoseUpdate& predicted, const PoseUpdate& update);
  [[nodiscard]] SweepCloud deskew_now(const PlacedSweep& sweep) const;
  void learn_pitch_latency(const SweepCloud& cloud, const PoseUpdate& update);
  void learn_pitch_latency_at_start(const PlacedSweep& sweep);
  [[nodiscard]] PosePrior predict(const SweepCloud& cloud, const PoseUpdate& update) const;
  void track(VoxelMap& sweep, const SweepCloud& cloud, PoseUpdate& update);
  void accept(const VoxelMap& sweep, SweepCloud& cloud, PoseUpdate& update);
  [[nodiscard]] std::optional<KeyframeReason> keyframe_reason(PoseUpdate& update) const;
  void keep(const PoseUpdate& update);
  void keep_keyframe(const VoxelMap& sweep, SweepCloud cloud);
  void close_loops(const VoxelMap& sweep);
  void move_keyframes(std::span<const geometry::SE3> T_map_keyframes);

  Slam6dParams params_;
  SweepSegmenter segmenter_;
  geometry::PoseHistory odometry_;
  ScanCounts scan_counts_;
  bool stream_was_interrupted_ = false;  // since the last sweep that could be placed

  OdometryCalibration calibration_;
  PitchLatency pitch_latency_;
  /// What pitch_latency_ compares the next sweep with: the last accepted one.
  struct NoddingSweep {
    geometry::SE3 T_map_base = geometry::SE3::Identity();
    geometry::SE3 T_first_base =
        geometry::SE3::Identity();  ///< as counted, in the first odom frame
    double pitch_rate_rad_s = 0.0;  ///< as far as the estimate follows it
    double pitch_variance = 0.0;
    double latency_s = 0.0;  ///< with which it was deskewed
    bool is_stationary = false;
  };
  std::optional<NoddingSweep> last_nod_;
  std::optional<PlacedSweep> first_sweep_;  // until the second
  VoxelMap map_;
  /// P_n * odo_n^-1 at the last beam of the last accepted sweep: the correction, map from odom.
  geometry::SE3 T_map_odom_ = geometry::SE3::Identity();
  /// That pose, in map and by odometry in the first odom frame, and its covariance.
  geometry::SE3 T_map_end_ = geometry::SE3::Identity();
  geometry::SE3 T_first_end_ = geometry::SE3::Identity();
  Matrix6d end_covariance_ = Matrix6d::Zero();
  /// The present odom frame in the first one.
  geometry::SE3 T_first_odom_ = geometry::SE3::Identity();
  std::optional<std::size_t> last_accepted_;  // sweep
  int lost_sweeps_ = 0;                       // since the last accepted one
  bool is_interrupted_ = false;               // since the last accepted one
  bool keyframe_is_due_ = false;              // there was an interruption since the last keyframe
  std::vector<PoseUpdate> sweeps_;
  CorrectedPoses corrected_;  // of sweeps_
  std::vector<Keyframe> keyframes_;
  BackEnd back_end_;
  Metrics counts_;
};

}  // namespace nodmap::slam6d
