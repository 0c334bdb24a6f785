// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid_tiles.hpp"

#include <algorithm>
#include <cstddef>

namespace nodmap::slam2d {
namespace {

constexpr int kTileCells = 240;

GridTile cut_tile(const OccupancyGrid& grid, int x, int y) {
  GridTile tile;
  tile.x = x;
  tile.y = y;
  tile.width = std::min(kTileCells, grid.width() - x);
  tile.height = std::min(kTileCells, grid.height() - y);
  tile.cells.reserve(static_cast<std::size_t>(tile.width) * static_cast<std::size_t>(tile.height));
  for (int row = y; row < y + tile.height; ++row) {
    for (int column = x; column < x + tile.width; ++column) {
      tile.cells.push_back(grid.occupancy(column, row));
    }
  }
  return tile;
}

}  // namespace

std::vector<GridTile> cut_into_tiles(const OccupancyGrid& grid) {
  std::vector<GridTile> tiles;
  for (int y = 0; y < grid.height(); y += kTileCells) {
    for (int x = 0; x < grid.width(); x += kTileCells) {
      tiles.push_back(cut_tile(grid, x, y));
    }
  }
  return tiles;
}

}  // namespace nodmap::slam2d
