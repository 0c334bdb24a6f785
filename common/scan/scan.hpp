// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::scan {

/// A scan: the ranges of one mirror revolution of a pitched 2D laser, with everything needed to
/// compute its points in base. Frames: `base` (x forward, y left, z up; the robot's centre of
/// rotation projected onto the ground), `mount` (the pitch axis), `laser` (mirror centre, pitched).
struct Scan {
  time::Timestamp stamp{};    ///< when the first beam was measured
  time::Duration duration{};  ///< from the first to the last beam; 0: all beams simultaneous
  std::int64_t seq = 0;       ///< counts the scans of one scanner, to detect losses

  double angle_first_rad = 0.0;  ///< first beam in the laser plane; 0 ahead, positive to the left
  double angle_step_rad = 0.0;   ///< from beam to beam

  double pitch_first_rad = 0.0;  ///< at the first beam; positive looks up
  double pitch_last_rad = 0.0;   ///< at the last beam
  bool pitch_measured = true;    ///< false: no feedback, the pitch is the commanded one

  double range_min_m = 0.0;  ///< shortest valid range; shorter ones hit the housing or the robot
  double range_max_m = 0.0;  ///< longest valid range

  geometry::SE3 T_base_mount = geometry::SE3::Identity();
  Eigen::Vector3d mirror_offset_m =
      Eigen::Vector3d::Zero();  ///< pitch axis to mirror, pitched frame

  /// Range along each beam, metres. +infinity: no echo, free up to `range_max_m`. NaN, or any other
  /// value outside [range_min_m, range_max_m]: no measurement.
  std::vector<float> ranges_m;

  [[nodiscard]] double angle_rad(std::size_t beam) const {
    return angle_first_rad + angle_step_rad * static_cast<double>(beam);
  }

  /// When a beam was measured, as a fraction of the scan: 0 the first beam, 1 the last.
  [[nodiscard]] double fraction(std::size_t beam) const {
    return ranges_m.size() < 2
               ? 0.0
               : static_cast<double>(beam) / static_cast<double>(ranges_m.size() - 1);
  }

  [[nodiscard]] double pitch_rad(std::size_t beam) const {
    return pitch_first_rad + fraction(beam) * (pitch_last_rad - pitch_first_rad);
  }

  [[nodiscard]] double pitch_mid_rad() const { return 0.5 * (pitch_first_rad + pitch_last_rad); }
  [[nodiscard]] time::Timestamp mid_stamp() const { return stamp + duration / 2; }
  [[nodiscard]] time::Timestamp last_stamp() const { return stamp + duration; }

  [[nodiscard]] bool is_hit(std::size_t beam) const {
    const auto r = static_cast<double>(ranges_m[beam]);
    return r >= range_min_m && r <= range_max_m;  // false for NaN and infinity
  }
};

/// Farther than any laser that pitches measures.
inline constexpr double kFarthestRangeM = 1000.0;
/// From base to the mount, and from there to the mirror, along each axis: larger than any robot.
inline constexpr double kFarthestMirrorM = 10.0;
/// From base to a point or a mirror of the same sweep: leaves as much again for the robot's motion.
inline constexpr double kFarthestPointM = 2.0 * kFarthestRangeM;

/// Whether the geometry of a scan is usable: finite angles, valid pitch, angle step and range
/// limits, a mount and a mirror on the robot. Does not check the single readings.
[[nodiscard]] bool is_plausible(const Scan& scan);

/// The direction of one beam in the mount frame (before the mount's own pose): Eq. 1 without its
/// translation, in our right-handed frame.
[[nodiscard]] Eigen::Vector3d beam_direction(double angle_rad, double pitch_rad);

/// Eq. 1: a point at `range_m` along a beam, in the base frame.
[[nodiscard]] Eigen::Vector3d point_in_base(const Scan& scan, std::size_t beam, double range_m);

/// Computes the points of whole scans (Eq. 1), with the pitch interpolated over the beams. Computes
/// the sines and cosines of the beam angles once per sensor configuration, and does not allocate
/// while this configuration stays the same.
class ScanProjector {
 public:
  /// The end point of a beam in base, with the index of the beam.
  struct Point {
    Eigen::Vector3d p_base;
    std::uint32_t beam = 0;
  };

  /// The points of all beams with a valid range, in beam order. Valid until the next call.
  [[nodiscard]] std::span<const Point> hits(const Scan& scan);

 private:
  void prepare_fan(const Scan& scan);

  double angle_first_rad_ = 0.0;
  double angle_step_rad_ = 0.0;
  std::vector<Eigen::Vector2d> fan_;  // cos and sin of each beam's angle in the laser plane
  std::vector<Point> points_;
};

}  // namespace nodmap::scan
