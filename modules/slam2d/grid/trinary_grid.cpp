// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid/trinary_grid.hpp"

#include <cmath>

namespace nodmap::slam2d {

TrinaryGrid trinary(const OccupancyGrid& grid) {
  TrinaryGrid states{.cell_size_m = grid.cell_size_m(),
                     .T_map_grid = {grid.origin().x(), grid.origin().y(), 0.0},
                     .width = grid.width(),
                     .height = grid.height()};
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      states.cells.push_back(grid.occupancy(x, y) == OccupancyGrid::kUnknown ? CellState::kUnknown
                             : grid.is_occupied(x, y)                        ? CellState::kOccupied
                                                                             : CellState::kFree);
    }
  }
  return states;
}

OccupancyGrid to_occupancy_grid(const TrinaryGrid& grid) {
  OccupancyGrid drawn(grid.cell_size_m);
  // In a rotated map, one point for each cell would leave cells out. Another one is moved by up to
  // half a cell, so that each of its cells is one of the grid.
  geometry::SE2 T_map_grid = grid.T_map_grid;
  const bool is_rotated = T_map_grid.yaw != 0.0;
  if (!is_rotated) {
    T_map_grid.x = grid.cell_size_m * std::round(T_map_grid.x / grid.cell_size_m);
    T_map_grid.y = grid.cell_size_m * std::round(T_map_grid.y / grid.cell_size_m);
  }
  const int per_edge = is_rotated ? 2 : 1;
  const double step_m = grid.cell_size_m / per_edge;
  for (int y = 0; y < per_edge * grid.height; ++y) {
    for (int x = 0; x < per_edge * grid.width; ++x) {
      const CellState state = grid.at(x / per_edge, y / per_edge);
      if (state != CellState::kUnknown) {
        drawn.add_cell(T_map_grid * Eigen::Vector2d((x + 0.5) * step_m, (y + 0.5) * step_m),
                       state == CellState::kOccupied);
      }
    }
  }
  return drawn;
}

}  // namespace nodmap::slam2d
