// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/scan/scan.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"
#include "modules/slam2d/scan/sweep_scan.hpp"

namespace nodmap::slam2d {

/// Leaves out the points of a level scan that lie on slopes: ramps, or the floor that a robot on a
/// ramp looks down on. Where a level scan meets a slope depends on the pitch, not only on where the
/// robot is, so the slope is no wall to match.
///
/// Along a beam, from scan to scan of a sweep, a wall stays where it is, and a slope recedes in
/// proportion to what the beam rises.
class SlopedPoints {
 public:
  /// Returns `points_base` without those on slopes, valid until the next call. `points_base`: the
  /// points of all hits of `level`, as OrientedPointExtractor extracts them. `below`: the
  /// two scans below `level` in its sweep, the nearer one first; what is above a ramp may be over
  /// it. All points are returned if the pitches do not differ or the head has turned round.
  [[nodiscard]] std::span<const OrientedPoint> remove(std::span<const OrientedPoint> points_base,
                                                      const SweepScan& level,
                                                      const std::array<SweepScan, 2>& below);

  /// Which points the last call has left out, by beam; empty if it has compared nothing.
  [[nodiscard]] const std::vector<bool>& are_left_out() const { return are_left_out_; }
  /// By beam: the points of the level scan of the last call that compared something.
  [[nodiscard]] const std::vector<OrientedPoint>& points_by_beam() const { return lines_; }
  [[nodiscard]] bool is_kept(std::size_t beam) const {
    return hits_[kLevel][beam].has_value() && !are_left_out_[beam];
  }

 private:
  static constexpr std::size_t kLevel = 2;  // in hits_

  void find_lines(std::span<const OrientedPoint> points_base);
  [[nodiscard]] double recession_m(std::size_t beam, const Eigen::Vector2d& p_base) const;
  [[nodiscard]] std::optional<bool> is_on_slope(std::size_t beam) const;
  [[nodiscard]] bool is_agreed(std::size_t beam) const;

  scan::ScanProjector projector_;
  std::array<BeamHits, 3> hits_;               // by increasing pitch
  std::vector<OrientedPoint> lines_;           // of the level scan, by beam
  std::vector<std::optional<bool>> findings_;  // by beam
  std::vector<bool> are_left_out_;             // by beam
  std::vector<OrientedPoint> points_;
};

}  // namespace nodmap::slam2d
