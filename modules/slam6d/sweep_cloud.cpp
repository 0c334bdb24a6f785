// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/sweep_cloud.hpp"

#include "common/geometry/pose_history.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// A scan with the robot's poses at its first and last beam.
struct PlacedScan {
  const scan::Scan* scan = nullptr;
  SE3 T_odom_first;
  SE3 T_odom_last;
};

std::vector<PlacedScan> place_scans(std::span<const scan::Scan> scans, const PoseLookup& pose_at) {
  std::vector<PlacedScan> placed;
  placed.reserve(scans.size());
  for (const scan::Scan& scan : scans) {
    const auto T_odom_first = pose_at(scan.utime_us);
    const auto T_odom_last = pose_at(scan.utime_last_us());
    if (T_odom_first && T_odom_last) {
      placed.push_back({&scan, *T_odom_first, *T_odom_last});
    }
  }
  return placed;
}

void append_scan(const PlacedScan& placed, const SE3& T_base_odom, const RangeLimits& range,
                 scan::ScanProjector& projector, SweepCloud& cloud) {
  const scan::Scan& scan = *placed.scan;
  const SE3 T_base_first = T_base_odom * placed.T_odom_first;
  const SE3 T_base_last = T_base_odom * placed.T_odom_last;
  const bool is_stationary = T_base_first.isApprox(T_base_last, 1e-12);
  for (const auto& hit : projector.hits(scan)) {
    const auto range_m = static_cast<double>(scan.ranges_m[hit.beam]);
    if (range_m < range.min_m || range_m > range.max_m) {
      continue;
    }
    const SE3 T_base_beam =
        is_stationary ? T_base_first
                      : geometry::interpolate(T_base_first, T_base_last, scan.fraction(hit.beam));
    cloud.points.emplace_back((T_base_beam * hit.p_base).cast<float>());
  }
  const Eigen::Vector3d p_mirror =
      scan.T_base_mount * (geometry::pitch_rotation(scan.pitch_mid_rad()) * scan.mirror_offset_m);
  const SE3 T_base_mid = geometry::interpolate(T_base_first, T_base_last, 0.5);
  cloud.lines.push_back({(T_base_mid * p_mirror).cast<float>(), cloud.points.size()});
}

}  // namespace

std::optional<SweepCloud> deskew(std::span<const scan::Scan> scans, const PoseLookup& pose_at,
                                 const RangeLimits& range) {
  const std::vector<PlacedScan> placed = place_scans(scans, pose_at);
  if (placed.empty()) {
    return std::nullopt;
  }
  SweepCloud cloud;
  const std::int64_t begin_us = placed.front().scan->utime_us;
  cloud.utime_us = begin_us + (placed.back().scan->utime_last_us() - begin_us) / 2;
  const auto T_odom_base = pose_at(cloud.utime_us);
  if (!T_odom_base) {
    return std::nullopt;
  }
  cloud.T_odom_base = *T_odom_base;
  cloud.scans_used = placed.size();
  cloud.scans_without_pose = scans.size() - placed.size();
  const SE3 T_base_odom = cloud.T_odom_base.inverse();
  const SE3 moved = placed.front().T_odom_first.inverse() * placed.back().T_odom_last;
  cloud.distance_m = moved.translation().norm();
  cloud.rotation_rad = geometry::rotation_angle(moved);
  scan::ScanProjector projector;
  for (const PlacedScan& scan : placed) {
    append_scan(scan, T_base_odom, range, projector, cloud);
  }
  return cloud;
}

}  // namespace nodmap::slam6d
