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
#include "modules/slam6d/model.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/registration.hpp"
#include "modules/slam6d/sweep_cloud.hpp"
#include "modules/slam6d/sweep_segmenter.hpp"

namespace nodmap::slam6d {

/// Why a sweep was registered.
enum class KeyframeReason { kFirst, kInterruption, kDistance, kRotation };

/// What became of one sweep.
struct SweepRecord {
  std::int64_t utime_us = 0;  ///< of its base pose
  geometry::SE3 T_odom_base = geometry::SE3::Identity();
  /// The odom frame of `T_odom_base` in the first one: identity until odometry begins anew.
  geometry::SE3 T_first_odom = geometry::SE3::Identity();
  geometry::SE3 T_map_base = geometry::SE3::Identity();  ///< as known when the sweep was complete
  std::size_t scans_used = 0;
  std::size_t scans_without_pose = 0;
  std::size_t num_points = 0;
  bool stood = false;  ///< the robot, during the whole sweep
  /// How far the extrapolated base pose was from the last keyframe's (0 for the first).
  double moved_m = 0.0;
  double turned_rad = 0.0;
  std::optional<KeyframeReason> keyframe = std::nullopt;  ///< empty: not registered
  /// Empty: not registered, or the first, which is the model.
  std::optional<Registration> registration = std::nullopt;
};

/// A registered sweep. Kept whole, so that model and occupancy map can be built anew from other
/// poses.
struct Keyframe {
  std::size_t sweep = 0;  ///< place of its record
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  SweepCloud cloud;  ///< in base
  Surface surface;   ///< in base
};

/// 6DOF-SLAM of section IV B: scans and odometry in, registered clouds and poses out.
class Slam6d {
 public:
  explicit Slam6d(const Slam6dParams& params);

  /// The robot's pose by odometry; returns whether it was taken (finite).
  bool add_odometry(std::int64_t utime_us, const geometry::SE3& T_odom_base);

  /// Odometry goes on in another frame: its newest pose and `T_new_odom_base` are one place, as far
  /// as anybody knows, and the robot stays where it was in the map. The running sweep ends, and its
  /// record is returned; odometry is forgotten, so that no beam is placed between the frames; the
  /// next sweep is registered as after an interruption.
  [[nodiscard]] std::optional<SweepRecord> change_odometry_frame(
      const geometry::SE3& T_new_odom_base);

  /// The next scan of the stream. Returns the record of the sweep it completes, if it does, and if
  /// there was odometry for it. The scan must be plausible (scan::is_plausible).
  [[nodiscard]] std::optional<SweepRecord> add_scan(scan::Scan scan);

  /// The unfinished sweep at the end of the stream.
  [[nodiscard]] std::optional<SweepRecord> flush();

  /// The same for a cloud that is one already: everything after the stripping of motion.
  SweepRecord add_cloud(SweepCloud cloud);

  [[nodiscard]] std::span<const SweepRecord> sweeps() const { return sweeps_; }
  [[nodiscard]] std::span<const Keyframe> keyframes() const { return keyframes_; }
  [[nodiscard]] const Model& model() const { return model_; }
  /// Scans that came out in sweeps, and those among them that had to be left out.
  [[nodiscard]] std::size_t scans_in_sweeps() const { return scans_in_sweeps_; }
  [[nodiscard]] std::size_t scans_without_pose() const { return scans_without_pose_; }

  /// The pose of every sweep, with all that is known now: keyframes as registered, the sweeps
  /// between two keyframes with a correction that goes over evenly from one to the next.
  [[nodiscard]] std::vector<geometry::SE3> trajectory() const;

 private:
  [[nodiscard]] std::optional<SweepRecord> process(const Sweep& sweep);
  [[nodiscard]] std::optional<KeyframeReason> keyframe_reason(const SweepRecord& record) const;
  void make_keyframe(SweepRecord& record, SweepCloud cloud);

  Slam6dParams params_;
  SweepSegmenter segmenter_;
  geometry::PoseHistory odometry_;
  Model model_;
  /// P_n * odo_n^-1 of the last keyframe: the correction, map from odom.
  geometry::SE3 T_map_odom_ = geometry::SE3::Identity();
  /// The present odom frame in the first one.
  geometry::SE3 T_first_odom_ = geometry::SE3::Identity();
  bool interrupted_ = false;  // since the last keyframe
  std::vector<SweepRecord> sweeps_;
  std::vector<Keyframe> keyframes_;
  std::size_t scans_in_sweeps_ = 0;
  std::size_t scans_without_pose_ = 0;
};

}  // namespace nodmap::slam6d
