// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid_tiles.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace nodmap::slam2d {
namespace {

TEST(GridTiles, CoverTheGridOnce) {
  OccupancyGrid grid(0.05);
  ASSERT_TRUE(grid.add_ray({0.0, 0.0}, {20.0, 11.0}));
  const std::vector<GridTile> tiles = cut_into_tiles(grid);
  ASSERT_GT(tiles.size(), 1U);
  std::vector<int> covered(
      static_cast<std::size_t>(grid.width()) * static_cast<std::size_t>(grid.height()), 0);
  for (const GridTile& tile : tiles) {
    ASSERT_EQ(tile.cells.size(), static_cast<std::size_t>(tile.width * tile.height));
    EXPECT_LE(tile.cells.size(), 240U * 240U);
    std::size_t cell = 0;
    for (int y = tile.y; y < tile.y + tile.height; ++y) {
      for (int x = tile.x; x < tile.x + tile.width; ++x) {
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
  EXPECT_TRUE(cut_into_tiles(OccupancyGrid(0.05)).empty());
}

}  // namespace
}  // namespace nodmap::slam2d
