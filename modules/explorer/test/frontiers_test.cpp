// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/frontiers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace nodmap::explorer {
namespace frontiers_test {

// A room of 4 m x 3 m, its left half free and the rest unknown, closed by walls; map cells.
PlanningGrid half_known_room() {
  std::vector<std::int8_t> cells(80 * 60, -1);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      const bool is_wall = x < 2 || y < 2 || y >= 58;
      cells[static_cast<std::size_t>(y * 80 + x)] = static_cast<std::int8_t>(x >= 40   ? -1
                                                                             : is_wall ? 100
                                                                                       : 0);
    }
  }
  PlanningGrid grid(0.2);
  EXPECT_TRUE(grid.add({0.05, {0, 0}, 80, 60, cells}));
  return grid;
}

TEST(Frontiers, AreTheFreeCellsBesideUnknownGround) {
  const PlanningGrid grid = half_known_room();
  ShortestPaths paths;
  paths.compute(grid, {1.0, 1.5});
  Frontiers frontiers;
  frontiers.find({grid, paths});
  // The whole border at x = 2 m without the walls: 28 cells.
  EXPECT_EQ(frontiers.cells().size(), 28U);
  EXPECT_TRUE(std::ranges::all_of(frontiers.cells(), [](const Cell& c) { return c.x() == 19; }));
}

TEST(Frontiers, LookoutsAreReachedNearAFrontierAndOneForEachBlock) {
  const PlanningGrid grid = half_known_room();
  ShortestPaths paths;
  paths.compute(grid, {0.5, 1.5});
  Frontiers frontiers;
  frontiers.find({grid, paths});
  const std::vector<Cell> lookouts = frontiers.lookouts({grid, paths}, 1.0);
  ASSERT_FALSE(lookouts.empty());
  std::set<std::pair<int, int>> blocks;
  double last_m = 0.0;
  for (const Cell& cell : lookouts) {
    EXPECT_TRUE(paths.is_reached(cell));
    EXPECT_GE(cell.x(), 9) << "more than 1 m off";
    EXPECT_GE(paths.length_m(cell), last_m);
    last_m = paths.length_m(cell);
    EXPECT_TRUE(blocks.emplace(cell.x() / 4, cell.y() / 4).second);
  }
}

TEST(Frontiers, AKnownRoomHasNone) {
  std::vector<std::int8_t> cells(40 * 40, 0);
  for (int i = 0; i < 40; ++i) {
    for (const int at : {i, 39 * 40 + i, 40 * i, 40 * i + 39}) {
      cells[static_cast<std::size_t>(at)] = 100;
    }
  }
  PlanningGrid grid(0.2);
  ASSERT_TRUE(grid.add({0.05, {0, 0}, 40, 40, cells}));
  ShortestPaths paths;
  paths.compute(grid, {1.0, 1.0});
  Frontiers frontiers;
  frontiers.find({grid, paths});
  EXPECT_TRUE(frontiers.cells().empty());
  EXPECT_TRUE(frontiers.lookouts({grid, paths}, 2.0).empty());
}

}  // namespace frontiers_test
}  // namespace nodmap::explorer
