// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid_tiles.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace nodmap::slam2d {
namespace {

TEST(GridTiles, CoverTheGridOnceAndFitAMessage) {
  OccupancyGrid grid(0.05);
  ASSERT_TRUE(grid.add_ray({0.0, 0.0}, {20.0, 11.0}));
  const auto tiles = cut_into_tiles(grid, 77, 3);
  ASSERT_GT(tiles.size(), 1U);
  std::vector<int> covered(
      static_cast<std::size_t>(grid.width()) * static_cast<std::size_t>(grid.height()), 0);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const nodmap::grid_chunk_t& tile = tiles[i];
    EXPECT_EQ(tile.utime, 77);
    EXPECT_EQ(tile.map_revision, 3);
    EXPECT_EQ(tile.chunk_index, static_cast<int>(i));
    EXPECT_EQ(tile.num_chunks, static_cast<int>(tiles.size()));
    EXPECT_EQ(tile.num_cells, tile.tile_width * tile.tile_height);
    EXPECT_EQ(tile.cells.size(), static_cast<std::size_t>(tile.num_cells));
    EXPECT_LT(tile.getEncodedSize(), 65'536);
    std::size_t cell = 0;
    for (int y = tile.tile_y; y < tile.tile_y + tile.tile_height; ++y) {
      for (int x = tile.tile_x; x < tile.tile_x + tile.tile_width; ++x) {
        EXPECT_EQ(tile.cells[cell++], grid.occupancy(x, y));
        ++covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width()) +
                  static_cast<std::size_t>(x)];
      }
    }
  }
  for (const int times : covered) {
    EXPECT_EQ(times, 1);
  }
}

TEST(GridTiles, AnEmptyGridHasNone) {
  EXPECT_TRUE(cut_into_tiles(OccupancyGrid(0.05), 0, 0).empty());
}

}  // namespace
}  // namespace nodmap::slam2d
