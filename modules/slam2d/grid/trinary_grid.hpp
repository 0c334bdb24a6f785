// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/grid/occupancy_grid.hpp"

namespace nodmap::slam2d {

enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

/// An occupancy grid as map files hold it: each cell is in one of three states.
struct TrinaryGrid {
  double cell_size_m = 0.05;
  geometry::SE2 T_map_grid = {};  ///< of the outer corner of cell (0, 0)
  int width = 0;
  int height = 0;
  std::vector<CellState> cells = {};  ///< row by row, x fastest

  /// kUnknown outside.
  [[nodiscard]] CellState at(int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < width && y < height;
    return inside ? cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(x)]
                  : CellState::kUnknown;
  }
  /// The middle of a cell, in map.
  [[nodiscard]] Eigen::Vector2d middle_of(int x, int y) const {
    return T_map_grid * Eigen::Vector2d((x + 0.5) * cell_size_m, (y + 0.5) * cell_size_m);
  }
};

[[nodiscard]] TrinaryGrid trinary(const OccupancyGrid& grid);
/// The same map as a grid of rays: one ray ended in, or passed through, each cell that is known.
[[nodiscard]] OccupancyGrid to_occupancy_grid(const TrinaryGrid& grid);

}  // namespace nodmap::slam2d
