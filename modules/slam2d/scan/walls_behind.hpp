// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "common/scan/scan.hpp"
#include "modules/slam2d/scan/sweep_scan.hpp"

namespace nodmap::slam2d {

/// The walls that a level scan does not show, because a slope is before them: the scans shortly
/// before it in its sweep see over the slope.
class WallsBehind {
 public:
  /// Where a scan was taken, in base at the level scan; nothing if it is not known.
  using Place = std::function<std::optional<SweepScan>(const scan::Scan&)>;

  /// Takes the next scan of a nodding scanner, level or not.
  void add(const scan::Scan& scan);

  /// The walls behind the points of `level` that are on slopes, by beam. `is_sloped`: by beam.
  [[nodiscard]] std::vector<std::optional<Eigen::Vector2d>> find(const scan::Scan& level,
                                                                 const std::vector<bool>& is_sloped,
                                                                 const Place& place);

 private:
  /// The scans above the level one in its sweep, if that goes down: by increasing pitch.
  [[nodiscard]] std::vector<const scan::Scan*> scans_above(const scan::Scan& level) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> wall_at(std::size_t beam,
                                                       const Eigen::Vector2d& sensor_origin) const;

  std::deque<scan::Scan> recent_;  // the newest last
  scan::ScanProjector projector_;
  std::vector<BeamHits> above_;  // by increasing pitch
};

}  // namespace nodmap::slam2d
