// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam6d/sweep/mount_error.hpp"

namespace nodmap::slam6d {

/// Rotation vectors (rad) at evenly spaced times from -1 to 1, linear in between.
inline constexpr int kBendKnots = 9;
using Bend = Eigen::Matrix<double, 3, kBendKnots>;

/// The knot before a time, and how far it is to the next one, from 0 to 1.
struct BendKnot {
  int index = 0;
  double fraction = 0.0;
};
[[nodiscard]] BendKnot knot_at(double time);

/// The part of the robot's motion within a sweep that odometry missed. It grows linearly with time,
/// from P_b in the middle of the sweep (time 0) to the first and the last beam (times -1 and 1). In
/// the frame of P_b.
struct MotionCorrection {
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();  ///< of the base at time 1
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();   ///< about the base, rotation vector
  /// Rotations besides: ground and heading change within a sweep. Zero in the middle.
  Bend bend_rad = Bend::Zero();

  /// The pose of the base at `time`, corrected.
  [[nodiscard]] geometry::SE3 correct(const geometry::SE3& T_base_then, double time) const;
};

/// The scans of a sweep, with the robot's poses by odometry at the first and the last beam of each.
struct PlacedSweep {
  struct PlacedScan {
    scan::Scan scan;
    geometry::SE3 T_odom_first = geometry::SE3::Identity();
    geometry::SE3 T_odom_last = geometry::SE3::Identity();
    double pitch_rate_rad_s = 0.0;  ///< from the scan before to the one after
  };

  std::vector<PlacedScan> scans;  ///< at least one
  time::Timestamp stamp{};        ///< of the base pose P_b: the middle of the sweep's time
  geometry::SE3 T_odom_base = geometry::SE3::Identity();
  std::size_t scans_without_pose = 0;  ///< left out
  /// Whether scans or their poses are missing since the sweep before.
  bool follows_interruption = false;
};

/// One 3D point cloud with one pose: what a scanner standing at the base pose would have seen
/// (IV B). Points in the base frame at that pose.
struct SweepCloud {
  /// A scan's part of the points: those up to (without) index `end`, seen from `p_base_mirror`.
  struct Line {
    Eigen::Vector3f p_base_mirror;
    std::size_t end = 0;
    double time = 0.0;         ///< of the scan: from -1 (the sweep's first beam) to 1 (the last)
    std::size_t free_end = 0;  ///< its part of `free_points`, likewise
    Eigen::Vector3f p_base_then = Eigen::Vector3f::Zero();  ///< where the base was
  };

  time::Timestamp stamp{};  ///< of the base pose P_b
  geometry::SE3 T_odom_base = geometry::SE3::Identity();
  std::vector<Eigen::Vector3f> points;
  /// Points on beams that met nothing: space is free up to them, as far as beams without an echo
  /// are believed.
  std::vector<Eigen::Vector3f> free_points;
  std::vector<Line> lines;
  std::size_t scans_used = 0;
  bool follows_interruption = false;  ///< as in PlacedSweep
  double pitch_rate_rad_s = 0.0;      ///< of the head, on average; positive: upwards
  /// The poses of the base at the first and the last beam.
  geometry::SE3 T_base_first = geometry::SE3::Identity();
  geometry::SE3 T_base_last = geometry::SE3::Identity();
  /// The same as odometry counted them, before calibration.
  geometry::SE3 T_base_first_counted = geometry::SE3::Identity();
  geometry::SE3 T_base_last_counted = geometry::SE3::Identity();

  /// The mirror in the middle of the sweep, during which it moves little; zero without lines.
  [[nodiscard]] Eigen::Vector3f p_base_mirror() const {
    return lines.empty() ? Eigen::Vector3f::Zero() : lines[lines.size() / 2].p_base_mirror;
  }
  /// The robot's motion from the first to the last beam.
  [[nodiscard]] geometry::SE3 motion() const { return T_base_first.inverse() * T_base_last; }
  /// The path of the base from the middle of the sweep to the last beam: the mean of both halves.
  [[nodiscard]] Eigen::Vector3d half_path() const {
    return 0.5 * (T_base_last.translation() - T_base_first.translation());
  }
  /// Whether the robot was stationary, as far as odometry tells.
  [[nodiscard]] bool is_stationary() const;
  /// Frees their memory when only the points are still needed.
  void drop_free_points();
  /// Deskews again: places each point anew with the motion as it is known now.
  void correct(const MotionCorrection& correction);
  /// Deskews again, as if an obstacle had stopped the base before the sweep, wherever its wheels
  /// went on. It turned as before.
  void stop();
};

/// Returns T_odom_base at a time; empty if it is not known.
using PoseLookup = std::function<std::optional<geometry::SE3>(time::Timestamp stamp)>;

/// Corrects a motion that odometry counted.
using Calibration = std::function<geometry::SE3(const geometry::SE3&)>;

/// Which points of a scan are used, by their distance from the mirror.
struct RangeLimits {
  double min_m = 0.5;
  double max_m = 30.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("min_m", min_m, {0.0, 10.0},
             "Points nearer to the mirror than this belong to the robot itself.");
    v.number("max_m", max_m, {0.5, 1000.0},
             "Points farther from the mirror than this are not used.");
  }
};

/// Looks up the pose of the robot at each scan. Scans without a pose are left out and counted;
/// empty if no scan has one.
[[nodiscard]] std::optional<PlacedSweep> place(std::vector<scan::Scan> scans,
                                               const PoseLookup& pose_at);

/// Deskews a sweep (IV B: the robot's movement during the pitching movement is stripped). Each beam
/// is placed with the pitch and the robot's pose at its own time, relative to the base pose P_b:
/// the pose in the middle of the sweep's time, from which the longest motion to a beam is shortest.
/// `pitch_latency_s`: how much later the pitch is stamped than the beams. `mount`: an error of the
/// laser's mount, which is corrected.
[[nodiscard]] SweepCloud deskew(const PlacedSweep& sweep, const RangeLimits& range,
                                const Calibration& calibrate, double pitch_latency_s,
                                const MountError& mount = {});

/// The same for scans whose poses are to be looked up.
[[nodiscard]] std::optional<SweepCloud> deskew(
    std::span<const scan::Scan> scans, const PoseLookup& pose_at, const RangeLimits& range,
    const Calibration& calibrate = [](const geometry::SE3& motion) { return motion; });

}  // namespace nodmap::slam6d
