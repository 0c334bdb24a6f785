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
#include "common/scan/scan.hpp"

namespace nodmap::slam6d {

/// One 3D point cloud with one pose: what a scanner standing at the base pose would have seen
/// (IV B). Points in the base frame at that pose.
struct SweepCloud {
  /// A scan's part of the points: those up to (without) index `end`, seen from `p_base_mirror`.
  struct Line {
    Eigen::Vector3f p_base_mirror;
    std::size_t end = 0;
  };

  std::int64_t utime_us = 0;  ///< of the base pose P_b
  geometry::SE3 T_odom_base = geometry::SE3::Identity();
  std::vector<Eigen::Vector3f> points;
  std::vector<Line> lines;
  std::size_t scans_used = 0;
  std::size_t scans_without_pose = 0;
  /// The robot's motion from the first to the last beam, by odometry.
  double distance_m = 0.0;
  double rotation_rad = 0.0;
};

/// Answers with T_odom_base at a time (us), empty where it is not known.
using PoseLookup = std::function<std::optional<geometry::SE3>(std::int64_t)>;

/// Which points of a scan are used, by their distance from the mirror.
struct RangeLimits {
  double min_m = 0.5;
  double max_m = 30.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("min_m", min_m, {0.0, 10.0}, "Points nearer to the mirror are the robot itself.");
    v.number("max_m", max_m, {0.5, 1000.0}, "Points farther from the mirror are not used.");
  }
};

/// Deskews a sweep (IV B: the robot's movement during the pitching movement is stripped): each beam
/// is placed with the pitch and the robot's pose at its own time, relative to the base pose P_b =
/// the pose in the middle of the sweep's time (the choice that makes the longest motion to a beam
/// shortest). Scans without a pose are left out and counted; empty when no scan has one.
[[nodiscard]] std::optional<SweepCloud> deskew(std::span<const scan::Scan> scans,
                                               const PoseLookup& pose_at, const RangeLimits& range);

}  // namespace nodmap::slam6d
