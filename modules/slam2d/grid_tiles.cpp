// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid_tiles.hpp"

#include <algorithm>

namespace nodmap::slam2d {
namespace {

constexpr int kTileCells = 240;  // 240 x 240 bytes and the head stay below 64 KiB

nodmap::grid_chunk_t cut_tile(const OccupancyGrid& grid, int x, int y) {
  nodmap::grid_chunk_t tile{};
  tile.cell_size_m = grid.cell_size_m();
  tile.origin_x_m = grid.origin().x();
  tile.origin_y_m = grid.origin().y();
  tile.grid_width = grid.width();
  tile.grid_height = grid.height();
  tile.tile_x = x;
  tile.tile_y = y;
  tile.tile_width = std::min(kTileCells, grid.width() - x);
  tile.tile_height = std::min(kTileCells, grid.height() - y);
  tile.num_cells = tile.tile_width * tile.tile_height;
  tile.cells.reserve(static_cast<std::size_t>(tile.num_cells));
  for (int row = y; row < y + tile.tile_height; ++row) {
    for (int column = x; column < x + tile.tile_width; ++column) {
      tile.cells.push_back(grid.occupancy(column, row));
    }
  }
  return tile;
}

}  // namespace

std::vector<nodmap::grid_chunk_t> cut_into_tiles(const OccupancyGrid& grid, std::int64_t utime_us,
                                                 std::int64_t map_revision) {
  std::vector<nodmap::grid_chunk_t> tiles;
  for (int y = 0; y < grid.height(); y += kTileCells) {
    for (int x = 0; x < grid.width(); x += kTileCells) {
      tiles.push_back(cut_tile(grid, x, y));
    }
  }
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    tiles[i].utime = utime_us;
    tiles[i].map_revision = map_revision;
    tiles[i].chunk_index = static_cast<std::int32_t>(i);
    tiles[i].num_chunks = static_cast<std::int32_t>(tiles.size());
  }
  return tiles;
}

}  // namespace nodmap::slam2d
