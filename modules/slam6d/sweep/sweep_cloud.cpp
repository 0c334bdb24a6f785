// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/sweep/sweep_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/pose_history.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

using PlacedScan = PlacedSweep::PlacedScan;

// The robot at the first and the last beam of a scan, relative to the base pose of the sweep.
struct ScanMotion {
  SE3 T_base_first;
  SE3 T_base_last;
};

// When the middle of a scan was measured: -1 at the sweep's first beam, 1 at its last.
double time_in_sweep(const scan::Scan& scan, time::Timestamp first, time::Timestamp last) {
  return last > first
             ? time::ratio((scan.mid_stamp() - first) - (last - scan.mid_stamp()), last - first)
             : 0.0;
}

// A beam without an echo met nothing up to here, or as far as the scanner measures, except black
// surfaces or glass. Only beams upwards are believed, because one that grazes the floor brings no
// echo, either.
constexpr double kFreeWithoutEchoM = 5.0;
constexpr float kNoEcho = std::numeric_limits<float>::infinity();

// From where a laser without roll on its head would see a point, to where this one does.
Eigen::Isometry3d roll_about_mirror(const scan::Scan& scan, const Eigen::Vector3d& p_base_mirror,
                                    double roll_rad) {
  const Eigen::Vector3d forward =
      scan.T_base_mount.linear() * geometry::pitch_rotation(scan.pitch_mid_rad()).col(0);
  return Eigen::Translation3d(p_base_mirror) * Eigen::AngleAxisd(roll_rad, forward) *
         Eigen::Translation3d(-p_base_mirror);
}

void append_scan(const scan::Scan& scan, const ScanMotion& motion, const RangeLimits& range,
                 double roll_rad, scan::ScanProjector& projector, SweepCloud& cloud) {
  const SE3& T_base_first = motion.T_base_first;
  const SE3& T_base_last = motion.T_base_last;
  const bool is_stationary = T_base_first.isApprox(T_base_last, 1e-12);
  const auto T_base_at = [&](std::size_t beam) {
    return is_stationary ? T_base_first
                         : geometry::interpolate(T_base_first, T_base_last, scan.fraction(beam));
  };
  const Eigen::Vector3d p_mirror =
      scan.T_base_mount * (geometry::pitch_rotation(scan.pitch_mid_rad()) * scan.mirror_offset_m);
  const SE3 roll = roll_rad == 0.0 ? SE3::Identity() : roll_about_mirror(scan, p_mirror, roll_rad);
  for (const auto& hit : projector.hits(scan)) {
    const auto range_m = static_cast<double>(scan.ranges_m[hit.beam]);
    if (range_m < range.min_m || range_m > range.max_m) {
      continue;
    }
    cloud.points.emplace_back((T_base_at(hit.beam) * (roll * hit.p_base)).cast<float>());
  }
  const double free_m = std::min({kFreeWithoutEchoM, range.max_m, scan.range_max_m});
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (scan.ranges_m[beam] != kNoEcho) {
      continue;
    }
    const Eigen::Vector3d p_base = roll * scan::point_in_base(scan, beam, free_m);
    if (p_base.z() > p_mirror.z()) {
      cloud.free_points.emplace_back((T_base_at(beam) * p_base).cast<float>());
    }
  }
  const SE3 T_base_mid = geometry::interpolate(T_base_first, T_base_last, 0.5);
  cloud.lines.push_back({.p_base_mirror = (T_base_mid * p_mirror).cast<float>(),
                         .end = cloud.points.size(),
                         .free_end = cloud.free_points.size(),
                         .p_base_then = T_base_mid.translation().cast<float>()});
}

// Over two scans the steps of the servo's reading hardly matter.
void find_pitch_rates(std::vector<PlacedScan>& scans) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const scan::Scan& before = scans[i > 0 ? i - 1 : 0].scan;
    const scan::Scan& after = scans[std::min(i + 1, scans.size() - 1)].scan;
    const double between_s = time::seconds(after.mid_stamp() - before.mid_stamp());
    scans[i].pitch_rate_rad_s =
        between_s > 0.0 ? (after.pitch_mid_rad() - before.pitch_mid_rad()) / between_s : 0.0;
  }
}

// Limits within a sweep: a tenth of the scanner's noise, near as well as at 10 m, and more than
// stopped wheels report.
constexpr double kStationaryM = 1e-3;
constexpr double kStationaryRad = 1e-4;

}  // namespace

bool SweepCloud::is_stationary() const {
  return motion().translation().norm() < kStationaryM &&
         geometry::rotation_angle(motion()) < kStationaryRad;
}

BendKnot knot_at(double time) {
  constexpr double kIntervals = kBendKnots - 1;
  const double place = 0.5 * kIntervals * (std::clamp(time, -1.0, 1.0) + 1.0);
  const double index = std::min(std::floor(place), kIntervals - 1.0);
  return {static_cast<int>(index), place - index};
}

SE3 MotionCorrection::correct(const SE3& T_base_then, double time) const {
  SE3 corrected = T_base_then;
  corrected.translation() += time * translation_m;
  const BendKnot knot = knot_at(time);
  const Eigen::Vector3d bend = (1.0 - knot.fraction) * bend_rad.col(knot.index) +
                               knot.fraction * bend_rad.col(knot.index + 1);
  corrected.linear() = geometry::rotation_of(time * rotation_rad + bend) * T_base_then.linear();
  return corrected;
}

void SweepCloud::correct(const MotionCorrection& correction) {
  const Eigen::Vector3d path = half_path();
  std::size_t i = 0;
  std::size_t i_free = 0;
  for (Line& line : lines) {
    SE3 T_base_then = SE3::Identity();
    T_base_then.translation() = line.time * path;
    const Eigen::Isometry3f change =
        (correction.correct(T_base_then, line.time) * T_base_then.inverse()).cast<float>();
    for (; i < line.end; ++i) {
      points[i] = change * points[i];
    }
    for (; i_free < line.free_end; ++i_free) {
      free_points[i_free] = change * free_points[i_free];
    }
    line.p_base_mirror = change * line.p_base_mirror;
    line.p_base_then = change * line.p_base_then;
  }
  T_base_first = correction.correct(T_base_first, -1.0);
  T_base_last = correction.correct(T_base_last, 1.0);
}

void SweepCloud::stop() {
  std::size_t i = 0;
  std::size_t i_free = 0;
  for (Line& line : lines) {
    for (; i < line.end; ++i) {
      points[i] -= line.p_base_then;
    }
    for (; i_free < line.free_end; ++i_free) {
      free_points[i_free] -= line.p_base_then;
    }
    line.p_base_mirror -= line.p_base_then;
    line.p_base_then.setZero();
  }
  T_base_first.translation().setZero();
  T_base_last.translation().setZero();
}

void SweepCloud::drop_free_points() {
  free_points = {};
  for (Line& line : lines) {
    line.free_end = 0;
  }
}

std::optional<PlacedSweep> place(std::vector<scan::Scan> scans, const PoseLookup& pose_at) {
  PlacedSweep sweep;
  sweep.scans.reserve(scans.size());
  for (scan::Scan& scan : scans) {
    const auto T_odom_first = pose_at(scan.stamp);
    const auto T_odom_last = pose_at(scan.last_stamp());
    if (T_odom_first && T_odom_last) {
      sweep.scans.push_back({std::move(scan), *T_odom_first, *T_odom_last});
    } else {
      ++sweep.scans_without_pose;
    }
  }
  if (sweep.scans.empty()) {
    return std::nullopt;
  }
  const time::Timestamp begin = sweep.scans.front().scan.stamp;
  sweep.stamp = begin + (sweep.scans.back().scan.last_stamp() - begin) / 2;
  const auto T_odom_base = pose_at(sweep.stamp);
  if (!T_odom_base) {
    return std::nullopt;
  }
  sweep.T_odom_base = *T_odom_base;
  find_pitch_rates(sweep.scans);
  return sweep;
}

SweepCloud deskew(const PlacedSweep& sweep, const RangeLimits& range, const Calibration& calibrate,
                  double pitch_latency_s, const MountError& mount) {
  SweepCloud cloud;
  cloud.stamp = sweep.stamp;
  cloud.T_odom_base = sweep.T_odom_base;
  cloud.scans_used = sweep.scans.size();
  cloud.follows_interruption = sweep.follows_interruption;
  const SE3 T_base_odom = sweep.T_odom_base.inverse();
  cloud.T_base_first_counted = T_base_odom * sweep.scans.front().T_odom_first;
  cloud.T_base_last_counted = T_base_odom * sweep.scans.back().T_odom_last;
  cloud.T_base_first = calibrate(cloud.T_base_first_counted);
  cloud.T_base_last = calibrate(cloud.T_base_last_counted);
  scan::ScanProjector projector;
  for (const PlacedScan& placed : sweep.scans) {
    scan::Scan scan = placed.scan;
    const double pitch_error_rad = mount.pitch_rad + pitch_latency_s * placed.pitch_rate_rad_s;
    scan.pitch_first_rad += pitch_error_rad;
    scan.pitch_last_rad += pitch_error_rad;
    cloud.pitch_rate_rad_s += placed.pitch_rate_rad_s / static_cast<double>(sweep.scans.size());
    append_scan(
        scan,
        {calibrate(T_base_odom * placed.T_odom_first), calibrate(T_base_odom * placed.T_odom_last)},
        range, mount.roll_rad, projector, cloud);
    cloud.lines.back().time = time_in_sweep(placed.scan, sweep.scans.front().scan.stamp,
                                            sweep.scans.back().scan.last_stamp());
  }
  return cloud;
}

std::optional<SweepCloud> deskew(std::span<const scan::Scan> scans, const PoseLookup& pose_at,
                                 const RangeLimits& range, const Calibration& calibrate) {
  const auto sweep = place({scans.begin(), scans.end()}, pose_at);
  return sweep ? std::optional(deskew(*sweep, range, calibrate, 0.0)) : std::nullopt;
}

}  // namespace nodmap::slam6d
