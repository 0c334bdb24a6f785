// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "modules/explorer/planning_grid.hpp"

namespace nodmap::explorer {

/// Shortest paths from one place to all others over passable cells (Dijkstra with buckets on the
/// 8-neighbourhood, up to 8 % longer than the straight line). Frame map.
class ShortestPaths {
 public:
  /// Paths start at the nearest passable cell within 0.4 m along x and y, because the robot may be
  /// nearer to an obstacle than a path may. With `targets`, the search ends when all of them have
  /// been reached.
  void compute(const PlanningGrid& grid, const Eigen::Vector2d& from_map,
               std::span<const Cell> targets = {});

  /// The passable cells that can be reached, the nearest first.
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] bool is_reached(const Cell& cell) const {
    return length_fifths_.contains(cell) && length_fifths_.at(cell) != kUnreached;
  }
  /// Length of the path to a cell, metres; +infinity if there is none.
  [[nodiscard]] double length_m(const Cell& cell) const;
  /// The cells of the path to a reached cell, starting near the robot.
  [[nodiscard]] std::vector<Cell> path_to(const Cell& cell) const;
  /// Heading in map at the end of the path to a cell, radians; `otherwise_rad` if the path is too
  /// short.
  [[nodiscard]] double heading_rad(const Cell& cell, double otherwise_rad) const;

 private:
  static constexpr std::uint32_t kUnreached = 0xFFFFFFFFU;
  /// One for each length that can be queued at a time: a step is at most 7 fifths of a cell long.
  static constexpr int kNumBuckets = 8;

  void push(const Cell& cell, std::uint32_t fifths, std::uint8_t parent);
  void push_neighbours(const PlanningGrid& grid, const Cell& cell, std::uint32_t fifths);
  void seed(const PlanningGrid& grid, const Eigen::Vector2d& from_map);

  double cell_size_m_ = 0.1;
  Raster<std::uint32_t> length_fifths_;  // of a cell: 5 along an axis, 7 diagonally
  Raster<std::uint8_t> parent_;          // direction of the step to a cell; 8: the path starts here
  std::array<std::vector<Cell>, kNumBuckets> buckets_;
  std::size_t num_queued_ = 0;
  std::vector<Cell> cells_;
};

/// Where the robot can go: the grid, and the shortest paths over it.
struct Reach {
  const PlanningGrid& grid;
  const ShortestPaths& paths;

  /// The centres of the cells on the path to a cell.
  [[nodiscard]] std::vector<Eigen::Vector2d> path_to(const Cell& cell) const;
};

}  // namespace nodmap::explorer
