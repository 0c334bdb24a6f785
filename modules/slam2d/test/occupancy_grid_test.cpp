// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace nodmap::slam2d {
namespace {

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

TEST(OccupancyGrid, OccupancyIsTheRatioOfRaysThatEnded) {
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
    // A straight line enters one cell for each border it crosses, and the first.
    const auto cell = [](double v) { return static_cast<int>(std::floor(v / kCell)); };
    EXPECT_EQ(known, 1 + std::abs(cell(end.x()) - cell(sensor_origin.x())) +
                         std::abs(cell(end.y()) - cell(sensor_origin.y())));
    for (double t = 0.0; t < 1.0; t += 0.003) {
      const Eigen::Vector2d p = sensor_origin + t * (end - sensor_origin);
      EXPECT_NE(occupancy_at(grid, p.x(), p.y()), OccupancyGrid::kUnknown);
    }
  }
}

TEST(OccupancyGrid, GrowingKeepsWhatWasDrawn) {
  OccupancyGrid grid(kCell);
  ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {1.05, 0.05}));
  ASSERT_TRUE(grid.add_ray({-40.0, -70.0}, {-41.0, -70.0}));
  ASSERT_TRUE(grid.add_ray({90.0, 30.0}, {90.0, 31.0}));
  EXPECT_EQ(occupancy_at(grid, 1.05, 0.05), 100);
  EXPECT_EQ(occupancy_at(grid, 0.55, 0.05), 0);
  EXPECT_EQ(occupancy_at(grid, 90.0, 31.0), 100);
}

TEST(OccupancyGrid, RefusesWhatNoGridCanHold) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  OccupancyGrid grid(kCell);
  EXPECT_FALSE(grid.add_ray({0, 0}, {kNan, 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {std::numeric_limits<double>::infinity(), 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {1e30, 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {1e5, 1e5}));
  EXPECT_EQ(grid.width(), 0);
}

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
