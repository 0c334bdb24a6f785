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
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/registration.hpp"
#include "modules/slam6d/sweep_cloud.hpp"
#include "modules/slam6d/sweep_segmenter.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// Why the map keeps a sweep.
enum class KeyframeReason { kFirst, kInterruption, kDistance, kRotation };

/// The robot's pose in the middle of one sweep, and how it was found.
struct PoseUpdate {
  std::int64_t utime_us = 0;  ///< of the base pose
  geometry::SE3 T_odom_base = geometry::SE3::Identity();
  /// The odom frame of `T_odom_base` in the first one: identity until odometry begins anew.
  geometry::SE3 T_first_odom = geometry::SE3::Identity();
  geometry::SE3 T_map_base = geometry::SE3::Identity();  ///< as known when the sweep was complete
  /// The correction of odometry as known at the sweep's last beam, for what comes after it.
  geometry::SE3 T_map_odom = geometry::SE3::Identity();
  /// Of the base's position (m) and rotation vector (rad), axes of map: of the match where the map
  /// tells the pose, else of odometry since then. Zero for the first sweep, which is the map.
  Matrix6d covariance = Matrix6d::Zero();
  std::size_t scans_used = 0;
  std::size_t scans_without_pose = 0;
  std::size_t num_points = 0;
  bool is_stationary = false;  ///< the robot, during the whole sweep
  /// From the last keyframe's base pose to this one (0 for the first).
  double distance_m = 0.0;
  double rotation_rad = 0.0;
  /// Empty: too thin a sweep, which follows odometry, or the first, which is the map.
  std::optional<Registration> registration = std::nullopt;
  std::optional<KeyframeReason> keyframe = std::nullopt;  ///< empty: not kept

  /// Whether the map tells this pose, not odometry alone.
  [[nodiscard]] bool is_tracked() const {
    return registration ? registration->is_accepted() : keyframe == KeyframeReason::kFirst;
  }
};

/// A sweep that the map keeps; whole, so that the occupancy map can be built anew from other poses.
struct Keyframe {
  std::size_t sweep = 0;  ///< place of its update
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  SweepCloud cloud;                   ///< in base
  std::vector<OrientedPoint> points;  ///< the voxel means of the cloud; normal zero where no plane
};

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
  [[nodiscard]] const ScanCounts& scan_counts() const { return scan_counts_; }
  [[nodiscard]] Metrics metrics() const;

  /// The pose of every sweep, with all that is known now: tracked sweeps as registered, those
  /// between two of them with a correction that goes over evenly from one to the next.
  [[nodiscard]] std::vector<geometry::SE3> trajectory() const;

 private:
  [[nodiscard]] std::optional<PlacedSweep> place_sweep(Sweep sweep);
  [[nodiscard]] bool is_better_beginning(const VoxelMap& sweep) const;
  void begin_anew(PoseUpdate& update);
  [[nodiscard]] PoseUpdate extrapolate(const SweepCloud& cloud) const;
  [[nodiscard]] bool is_usable(const PoseUpdate& update) const;
  [[nodiscard]] OdometryMotion motion_since_accepted(const SweepCloud& cloud) const;
  [[nodiscard]] geometry::SE3 counted_since_accepted(const geometry::SE3& T_odom_base) const;
  void calibrate(const SweepCloud& cloud, const PoseUpdate& predicted, const PoseUpdate& update);
  [[nodiscard]] PosePrior predict(const SweepCloud& cloud, const PoseUpdate& update) const;
  void track(VoxelMap& sweep, const SweepCloud& cloud, PoseUpdate& update);
  void accept(const VoxelMap& sweep, SweepCloud& cloud, PoseUpdate& update);
  [[nodiscard]] std::optional<KeyframeReason> keyframe_reason(PoseUpdate& update) const;

  Slam6dParams params_;
  SweepSegmenter segmenter_;
  geometry::PoseHistory odometry_;
  ScanCounts scan_counts_;
  bool stream_was_interrupted_ = false;  // since the last sweep that could be placed

  OdometryCalibration calibration_;
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
  std::vector<Keyframe> keyframes_;
  Metrics counts_;
};

}  // namespace nodmap::slam6d
