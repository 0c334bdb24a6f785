// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "modules/slam2d/occupancy_grid.hpp"

namespace nodmap::slam2d {

/// A rectangle out of a grid.
struct GridTile {
  int x = 0;  ///< its first cell in the grid
  int y = 0;
  int width = 0;
  int height = 0;
  std::vector<std::int8_t> cells;  ///< occupancy row by row, x fastest
};

/// Cuts the grid into tiles of at most 240 x 240 cells: with one byte a cell and the head of the
/// message they stay below 64 KiB.
[[nodiscard]] std::vector<GridTile> cut_into_tiles(const OccupancyGrid& grid);

}  // namespace nodmap::slam2d
