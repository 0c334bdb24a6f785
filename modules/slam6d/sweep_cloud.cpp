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
  SE3 T_base_first = SE3::Identity();
  SE3 T_base_last = SE3::Identity();
};

std::vector<PlacedScan> place_scans(std::span<const scan::Scan> scans, const PoseLookup& pose_at) {
  std::vector<PlacedScan> placed;
  placed.reserve(scans.size());
  for (const scan::Scan& scan : scans) {
    const auto T_odom_first = pose_at(scan.utime_us);
    const auto T_odom_last = pose_at(scan.utime_last_us());
    if (T_odom_first && T_odom_last) {
      placed.push_back({.scan = &scan, .T_odom_first = *T_odom_first, .T_odom_last = *T_odom_last});
    }
  }
  return placed;
}

// When the middle of a scan was measured: -1 at the sweep's first beam, 1 at its last.
double time_in_sweep(const scan::Scan& scan, std::int64_t first_us, std::int64_t last_us) {
  return last_us > first_us ? static_cast<double>(2 * scan.utime_mid_us() - first_us - last_us) /
                                  static_cast<double>(last_us - first_us)
                            : 0.0;
}

void append_scan(const PlacedScan& placed, const RangeLimits& range, scan::ScanProjector& projector,
                 SweepCloud& cloud) {
  const scan::Scan& scan = *placed.scan;
  const SE3& T_base_first = placed.T_base_first;
  const SE3& T_base_last = placed.T_base_last;
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

SE3 MotionCorrection::correct(const SE3& T_base_then, double time) const {
  SE3 corrected = T_base_then;
  corrected.translation() += time * translation_m;
  corrected.linear() = geometry::rotation_of(time * rotation_rad) * T_base_then.linear();
  return corrected;
}

void SweepCloud::correct(const MotionCorrection& correction) {
  const Eigen::Vector3d path = half_path();
  std::size_t i = 0;
  for (Line& line : lines) {
    SE3 T_base_then = SE3::Identity();
    T_base_then.translation() = line.time * path;
    const Eigen::Isometry3f change =
        (correction.correct(T_base_then, line.time) * T_base_then.inverse()).cast<float>();
    for (; i < line.end; ++i) {
      points[i] = change * points[i];
    }
    line.p_base_mirror = change * line.p_base_mirror;
  }
  T_base_first = correction.correct(T_base_first, -1.0);
  T_base_last = correction.correct(T_base_last, 1.0);
}

std::optional<SweepCloud> deskew(std::span<const scan::Scan> scans, const PoseLookup& pose_at,
                                 const RangeLimits& range, const Calibration& calibrate) {
  std::vector<PlacedScan> placed = place_scans(scans, pose_at);
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
  for (PlacedScan& scan : placed) {
    scan.T_base_first = calibrate(T_base_odom * scan.T_odom_first);
    scan.T_base_last = calibrate(T_base_odom * scan.T_odom_last);
  }
  cloud.T_base_first = placed.front().T_base_first;
  cloud.T_base_last = placed.back().T_base_last;
  cloud.T_base_first_counted = T_base_odom * placed.front().T_odom_first;
  cloud.T_base_last_counted = T_base_odom * placed.back().T_odom_last;
  scan::ScanProjector projector;
  for (const PlacedScan& scan : placed) {
    append_scan(scan, range, projector, cloud);
    cloud.lines.back().time =
        time_in_sweep(*scan.scan, begin_us, placed.back().scan->utime_last_us());
  }
  return cloud;
}

}  // namespace nodmap::slam6d
