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

/// Finds the points of a level scan that lie on slopes: ramps, or the floor that a robot on a
/// ramp looks down on. Where a level scan meets a slope depends on the pitch, not only on where the
/// robot is, so the slope is no wall to match.
///
/// Along a beam, from scan to scan of a sweep, a wall stays where it is, and a slope recedes in
/// proportion to what the beam rises.
class SlopedPoints {
 public:
  /// Returns whether any points are on slopes. `points_base`: the points of all hits of `level`, as
  /// OrientedPointExtractor extracts them. `below`: the two scans below `level` in its sweep, the
  /// nearer one first; what is above a ramp may be over it. Finds none if the pitches do not differ
  /// or the head has turned round.
  [[nodiscard]] bool find(std::span<const OrientedPoint> points_base, const SweepScan& level,
                          const std::array<SweepScan, 2>& below);

  /// By beam: which points the last call has found, if any.
  [[nodiscard]] const std::vector<bool>& are_on_slopes() const { return are_on_slopes_; }
  /// The point of a beam that is on no slope, if there is one; only if the last call has found any.
  [[nodiscard]] const OrientedPoint* other_point(std::size_t beam) const {
    return hits_[kLevel][beam] && !are_on_slopes_[beam] ? &lines_[beam] : nullptr;
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
  std::vector<bool> are_on_slopes_;            // by beam
};

}  // namespace nodmap::slam2d
