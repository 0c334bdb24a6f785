// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "modules/slam2d/point_map.hpp"

namespace nodmap::slam2d {

/// Upper bounds of how well a scan fits the map, for many places of the scan at once. A point
/// scores 1 on a map point, less with distance, and 0 beyond a maximum distance; normals are
/// ignored. To compute a bound, one byte is read per point.
class ScoreBound {
 public:
  /// Edge of a cell: places of the scan differ by whole cells.
  static constexpr double kCellM = 0.125;

  /// `middle`: the middle of the covered area, in map; `max_distance_m`: a point this far from the
  /// map scores 0; `max_shift_cells`: greatest shift of a scan along x or y.
  ScoreBound(const PointMap& map, const Eigen::Vector2d& middle, double max_distance_m,
             int max_shift_cells);

  /// The cells of the points of a scan, given in map; an argument of at().
  [[nodiscard]] std::vector<std::size_t> cells_of(std::span<const Eigen::Vector2d> points) const;

  /// Returns an upper bound of the mean score of the points, shifted by (x, y) cells; 0 without
  /// points.
  [[nodiscard]] double at(std::span<const std::size_t> cells, int x, int y) const;

 private:
  void stamp(const Eigen::Vector2d& point, double max_distance_m);

  Eigen::Vector2d origin_;  // outer corner of cell (0, 0)
  int max_shift_;
  int width_;
  std::vector<std::uint8_t> scores_;  // row by row, rounded up
};

}  // namespace nodmap::slam2d
