// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "modules/slam2d/grid/trinary_grid.hpp"

namespace nodmap::slam2d {
namespace occupancy_grid_test {

constexpr double kCell = 0.1;

std::int8_t occupancy_at(const OccupancyGrid& grid, double x_m, double y_m) {
  const Eigen::Vector2d cell = (Eigen::Vector2d(x_m, y_m) - grid.origin()) / kCell;
  return grid.occupancy(static_cast<int>(std::floor(cell.x())),
                        static_cast<int>(std::floor(cell.y())));
}

TEST(OccupancyGrid, ARayFreesItsCellsAndOccupiesTheLast) {
  OccupancyGrid grid(kCell);
  ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {1.05, 0.05}));
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(occupancy_at(grid, 0.05 + 0.1 * i, 0.05), 0);
  }
  EXPECT_EQ(occupancy_at(grid, 1.05, 0.05), 100);
  EXPECT_EQ(occupancy_at(grid, 1.15, 0.05), OccupancyGrid::kUnknown);
  EXPECT_EQ(occupancy_at(grid, 0.55, 0.15), OccupancyGrid::kUnknown);
}

TEST(OccupancyGrid, OccupancyIsTheFractionOfRaysThatEndInTheCell) {
  OccupancyGrid grid(kCell);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {2.05, 0.05}));
  }
  ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {1.05, 0.05}));
  EXPECT_EQ(occupancy_at(grid, 1.05, 0.05), 25);
}

TEST(OccupancyGrid, RaysAgreeWithDenseSampling) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d sensor_origin(coordinate(random), coordinate(random));
    const Eigen::Vector2d end(coordinate(random), coordinate(random));
    OccupancyGrid grid(kCell);
    ASSERT_TRUE(grid.add_ray(sensor_origin, end));
    EXPECT_EQ(occupancy_at(grid, end.x(), end.y()), 100);
    int known = 0;
    for (int y = 0; y < grid.height(); ++y) {
      for (int x = 0; x < grid.width(); ++x) {
        known += grid.occupancy(x, y) != OccupancyGrid::kUnknown ? 1 : 0;
      }
    }
    // A straight line enters one cell for each cell border it crosses, in addition to the first
    // cell.
    const auto cell = [](double v) { return static_cast<int>(std::floor(v / kCell)); };
    EXPECT_EQ(known, 1 + std::abs(cell(end.x()) - cell(sensor_origin.x())) +
                         std::abs(cell(end.y()) - cell(sensor_origin.y())));
    for (double t = 0.0; t < 1.0; t += 0.003) {
      const Eigen::Vector2d p = sensor_origin + t * (end - sensor_origin);
      EXPECT_NE(occupancy_at(grid, p.x(), p.y()), OccupancyGrid::kUnknown);
    }
  }
}

TEST(OccupancyGrid, GrowingKeepsTheCells) {
  OccupancyGrid grid(kCell);
  ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {1.05, 0.05}));
  ASSERT_TRUE(grid.add_ray({-40.0, -70.0}, {-41.0, -70.0}));
  ASSERT_TRUE(grid.add_ray({90.05, 30.05}, {90.05, 31.05}));
  EXPECT_EQ(occupancy_at(grid, 1.05, 0.05), 100);
  EXPECT_EQ(occupancy_at(grid, 0.55, 0.05), 0);
  EXPECT_EQ(occupancy_at(grid, 90.05, 31.05), 100);
}

TEST(OccupancyGrid, RefusesRaysThatNoGridCanHold) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  OccupancyGrid grid(kCell);
  EXPECT_FALSE(grid.add_ray({0, 0}, {kNan, 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {std::numeric_limits<double>::infinity(), 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {1e30, 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {1e5, 1e5}));
  EXPECT_EQ(grid.width(), 0);
}

TEST(OccupancyGrid, AFreeRayOccupiesNoCell) {
  OccupancyGrid grid(kCell);
  ASSERT_TRUE(grid.add_free_ray({0.05, 0.05}, {1.05, 0.05}));
  EXPECT_EQ(occupancy_at(grid, 0.95, 0.05), 0);
  EXPECT_EQ(occupancy_at(grid, 1.05, 0.05), OccupancyGrid::kUnknown);
  grid.remove_free_ray({0.05, 0.05}, {1.05, 0.05});
  EXPECT_EQ(occupancy_at(grid, 0.95, 0.05), OccupancyGrid::kUnknown);
}

TEST(OccupancyGrid, HoldsTilesOnlyWhereRaysPassed) {
  OccupancyGrid grid(kCell);
  ASSERT_TRUE(grid.add_ray({1.0, 1.0}, {2.0, 1.0}));
  ASSERT_TRUE(grid.add_ray({200.0, 200.0}, {201.0, 200.0}));
  EXPECT_EQ(grid.num_tiles(), 2U);
  EXPECT_GE(grid.width(), 16 * OccupancyGrid::kTileCells);  // 200 m
}

// The grid as a receiver assembles it from the tiles.
using Received = std::vector<std::int8_t>;

void receive(const OccupancyGrid& grid, const std::vector<GridTile>& tiles, Received& received) {
  const auto width = static_cast<std::size_t>(grid.width());
  received.resize(width * static_cast<std::size_t>(grid.height()), OccupancyGrid::kUnknown);
  for (const GridTile& tile : tiles) {
    ASSERT_EQ(tile.cells.size(),
              std::size_t{OccupancyGrid::kTileCells} * OccupancyGrid::kTileCells);
    for (std::size_t i = 0; i < tile.cells.size(); ++i) {
      const std::size_t x = static_cast<std::size_t>(tile.x) + i % OccupancyGrid::kTileCells;
      const std::size_t y = static_cast<std::size_t>(tile.y) + i / OccupancyGrid::kTileCells;
      received[y * width + x] = tile.cells[i];
    }
  }
}

Received whole(const OccupancyGrid& grid) {
  Received cells;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      cells.push_back(grid.occupancy(x, y));
    }
  }
  return cells;
}

// A grid with rays all over 128 m x 128 m: at least 100 tiles.
OccupancyGrid large_grid() {
  OccupancyGrid grid(kCell);
  for (double y = -64.0; y < 64.0; y += 6.4) {
    EXPECT_TRUE(grid.add_ray({-63.9, y}, {63.9, y + 3.0}));
  }
  return grid;
}

TEST(TileSelector, TheFirstChoiceIsTheWholeGrid) {
  const OccupancyGrid grid = large_grid();
  TileSelector selector;
  Received received;
  receive(grid, selector.choose(grid), received);
  EXPECT_EQ(received, whole(grid));
}

TEST(TileSelector, ChoosesChangedTilesAndAFewOthersFromALargeGrid) {
  OccupancyGrid grid = large_grid();
  ASSERT_GE(grid.num_tiles(), 100U);
  TileSelector selector;
  (void)selector.choose(grid);
  EXPECT_EQ(selector.choose(grid).size(), 4U);
  ASSERT_TRUE(grid.add_ray({1.05, 1.05}, {2.05, 1.05}));  // within one tile
  const std::vector<GridTile> chosen = selector.choose(grid);
  EXPECT_EQ(chosen.size(), 4U);
  EXPECT_EQ(grid.cut_tile(chosen.front().number).cells, chosen.front().cells);
  EXPECT_EQ(chosen.front().cells[10U * OccupancyGrid::kTileCells + 20U], 100);  // (2.05, 1.05)
}

TEST(TileSelector, ALateReceiverHasTheWholeGridAfterAllTilesWereRepeated) {
  const OccupancyGrid grid = large_grid();
  TileSelector selector;
  (void)selector.choose(grid);
  Received received;
  for (std::size_t sent = 0; sent < grid.num_tiles();) {
    const std::vector<GridTile> tiles = selector.choose(grid);
    sent += tiles.size();
    receive(grid, tiles, received);
  }
  EXPECT_EQ(received, whole(grid));
}

TEST(TileSelector, AChangeThatLeavesACellOccupiedIsSentAtTheEnd) {
  OccupancyGrid grid = large_grid();
  ASSERT_TRUE(grid.add_ray({1.05, 1.05}, {2.05, 1.05}));
  TileSelector selector;
  Received received;
  receive(grid, selector.choose(grid), received);
  // A ray passes through the wall. The cell is still occupied, although only half of the rays end
  // there.
  ASSERT_TRUE(grid.add_free_ray({1.05, 1.05}, {2.15, 1.05}));
  EXPECT_EQ(selector.choose(grid).size(), 4U);
  receive(grid, selector.choose_rest(grid), received);
  EXPECT_EQ(received, whole(grid));
  EXPECT_TRUE(selector.choose_rest(grid).empty());
}

TEST(TileSelector, AnEmptyGridHasNoTiles) {
  TileSelector selector;
  EXPECT_TRUE(selector.choose(OccupancyGrid(kCell)).empty());
  EXPECT_TRUE(selector.choose_rest(OccupancyGrid(kCell)).empty());
}

// The map's corner is in the middle of a cell of the grid.
TEST(ToOccupancyGrid, EachCellOfAMapFileIsOneOfTheGrid) {
  TrinaryGrid map{
      .cell_size_m = 0.05, .T_map_grid = {-12.225, -3.125, 0.0}, .width = 800, .height = 20};
  map.cells.assign(800 * 20, CellState::kFree);
  const OccupancyGrid grid = to_occupancy_grid(map);
  int num_known = 0;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      num_known += grid.occupancy(x, y) == OccupancyGrid::kUnknown ? 0 : 1;
    }
  }
  EXPECT_EQ(num_known, 800 * 20);
}

// The rotated cells of a map file cover the grid: no cell within the map stays unknown.
TEST(ToOccupancyGrid, ARotatedMapHasNoHoles) {
  TrinaryGrid map{.cell_size_m = 0.1, .T_map_grid = {3.0, -2.0, 0.5}, .width = 40, .height = 30};
  map.cells.assign(40 * 30, CellState::kFree);
  const OccupancyGrid grid = to_occupancy_grid(map);
  int num_inside = 0;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      const Eigen::Vector2d p_map = grid.origin() + 0.1 * Eigen::Vector2d(x + 0.5, y + 0.5);
      const Eigen::Vector2d cell = (map.T_map_grid.inverse() * p_map) / 0.1;
      const bool is_inside = (cell.array() > 1.0).all() && cell.x() < 39.0 && cell.y() < 29.0;
      ASSERT_TRUE(!is_inside || grid.occupancy(x, y) == 0) << p_map.transpose();
      num_inside += is_inside ? 1 : 0;
    }
  }
  EXPECT_GT(num_inside, 1000);  // of 1064
}

}  // namespace occupancy_grid_test
}  // namespace nodmap::slam2d
