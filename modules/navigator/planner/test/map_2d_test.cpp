// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/map_2d.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace nodmap::navigator {
namespace map_2d_test {

using geometry::MapTile;
using Kind = Map2d::Kind;

constexpr std::int8_t kFree = 0;
constexpr std::int8_t kOccupied = 100;
constexpr std::int8_t kUnknown = -1;

Kind at(const Map2d& map, int x, int y) {
  std::vector<Kind> row(1, Kind::kOccupied);
  map.read_row({x, y}, row);
  return row.front();
}

// A tile with the same value everywhere.
struct Uniform {
  Uniform(double cell_size_m, const Eigen::Vector2i& first, int width, int height,
          std::int8_t value)
      : cells(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value),
        tile{cell_size_m, first, width, height, cells} {}
  std::vector<std::int8_t> cells;
  MapTile tile;
};

TEST(Map2d, KeepsTilesWhereTheyAreAndIsUnknownElsewhere) {
  const std::vector<std::int8_t> cells{kFree, 24, 25, kUnknown, kOccupied, kFree};
  Map2d map;
  EXPECT_TRUE(map.is_empty());
  ASSERT_TRUE(map.add({0.05, {-2, 127}, 3, 2, cells}));  // across four blocks
  std::vector<Kind> row(5, Kind::kOccupied);
  map.read_row({-3, 127}, row);
  EXPECT_EQ(row, (std::vector{Kind::kUnknown, Kind::kFree, Kind::kFree, Kind::kOccupied,
                              Kind::kUnknown}));
  map.read_row({-3, 128}, row);
  EXPECT_EQ(row, (std::vector{Kind::kUnknown, Kind::kUnknown, Kind::kOccupied, Kind::kFree,
                              Kind::kUnknown}));
  EXPECT_EQ(at(map, 100'000, -100'000), Kind::kUnknown);
}

TEST(Map2d, ATileReplacesWhatItCovers) {
  Map2d map;
  ASSERT_TRUE(map.add(Uniform(0.05, {0, 0}, 4, 4, kOccupied).tile));
  ASSERT_TRUE(map.add(Uniform(0.05, {2, 0}, 2, 4, kFree).tile));
  EXPECT_EQ(at(map, 1, 3), Kind::kOccupied);
  EXPECT_EQ(at(map, 2, 3), Kind::kFree);
  ASSERT_TRUE(map.add(Uniform(0.05, {0, 0}, 4, 4, kUnknown).tile));
  EXPECT_EQ(at(map, 1, 3), Kind::kUnknown);
}

// The oracle: a cell of the plan is that of the greatest of all points in it.
TEST(Map2d, OtherCellSizesGiveTheGreatestOfWhatACellOverlaps) {
  for (const double cell_size_m : {0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.2}) {
    constexpr int kSize = 41;
    const Eigen::Vector2i first(-17, -20);
    std::vector<std::int8_t> cells;
    for (int i = 0; i < kSize * kSize; ++i) {
      cells.push_back(i % 7 == 0 ? kOccupied : i % 3 == 0 ? kUnknown : kFree);
    }
    Map2d map;
    ASSERT_TRUE(map.add({cell_size_m, first, kSize, kSize, cells}));
    const auto value_at = [&](double x_m, double y_m) {
      const int column = static_cast<int>(std::floor(x_m / cell_size_m)) - first.x();
      const int row = static_cast<int>(std::floor(y_m / cell_size_m)) - first.y();
      return cells[static_cast<std::size_t>(kSize * row + column)];
    };
    // Only cells of the plan that lie in the tile as a whole; the border of tiles is tested below.
    const auto line_after = [&](int cell) {
      return static_cast<int>(std::ceil(cell * cell_size_m / 0.05)) + 1;
    };
    for (int y = line_after(first.y()); 0.05 * (y + 1) < (first.y() + kSize) * cell_size_m; ++y) {
      for (int x = line_after(first.x()); 0.05 * (x + 1) < (first.x() + kSize) * cell_size_m; ++x) {
        auto greatest = std::int8_t{kUnknown};
        for (double dy = 0.0005; dy < 0.05; dy += 0.001) {
          for (double dx = 0.0005; dx < 0.05; dx += 0.001) {
            greatest = std::max(greatest, value_at(0.05 * x + dx, 0.05 * y + dy));
          }
        }
        EXPECT_EQ(at(map, x, y), greatest == kOccupied ? Kind::kOccupied
                                 : greatest == kFree   ? Kind::kFree
                                                       : Kind::kUnknown)
            << cell_size_m << " m: " << x << ", " << y;
      }
    }
  }
}

constexpr int kTile = 32;

// One of three tiles in a row along an axis, with a wall one cell thick across it if the wall's
// cell, counted along the row, is in this tile.
Uniform tile_with_wall(double cell_size_m, int axis, int index, int wall) {
  Eigen::Vector2i first(0, 0);
  first[axis] = kTile * index;
  Uniform uniform(cell_size_m, first, kTile, kTile, kFree);
  for (int i = 0; i < kTile && wall >= 0 && wall / kTile == index; ++i) {
    const int along = wall % kTile;
    const int cell = axis == 0 ? kTile * i + along : kTile * along + i;
    uniform.cells[static_cast<std::size_t>(cell)] = kOccupied;
  }
  return uniform;
}

// Which cells of the plan along an axis are occupied.
std::vector<int> occupied(const Map2d& map, int axis) {
  std::vector<int> cells;
  for (int i = -1; i < 160; ++i) {
    if ((axis == 0 ? at(map, i, 1) : at(map, 1, i)) == Kind::kOccupied) {
      cells.push_back(i);
    }
  }
  return cells;
}

// A wall is in all cells of the plan that it overlaps, wherever the border of two tiles is and in
// whichever order they come. It goes when the tile that it was in comes without it.
TEST(Map2d, AWallAtTheBorderOfTwoTilesIsInThePlan) {
  for (const double cell_size_m : {0.01, 0.015, 0.02, 0.03, 0.05, 0.08}) {
    for (int i = 0; i < 2 * 3 * kTile; ++i) {
      const int axis = i % 2;
      const int wall = i / 2;
      std::vector<int> expected;
      // More than a rounding error of a cell.
      for (int cell = static_cast<int>(std::floor(wall * cell_size_m / 0.05 + 1e-6));
           0.05 * cell < (wall + 1) * cell_size_m - 1e-6; ++cell) {
        expected.push_back(cell);
      }
      for (const auto& order : {std::array{0, 1, 2}, std::array{2, 1, 0}, std::array{1, 2, 0}}) {
        Map2d map;
        for (const int index : order) {
          ASSERT_TRUE(map.add(tile_with_wall(cell_size_m, axis, index, wall).tile));
        }
        ASSERT_EQ(occupied(map, axis), expected) << cell_size_m << " m, cell " << wall;
        ASSERT_TRUE(map.add(tile_with_wall(cell_size_m, axis, wall / kTile, -1).tile));
        ASSERT_EQ(occupied(map, axis), std::vector<int>()) << cell_size_m << " m, cell " << wall;
      }
    }
  }
}

TEST(Map2d, TheExtentIsThatOfWhatHasBeenKnown) {
  Map2d map;
  ASSERT_TRUE(map.add(Uniform(0.05, {0, 0}, 128, 128, kUnknown).tile));
  EXPECT_FALSE(map.extent());
  ASSERT_TRUE(map.add(Uniform(0.05, {3, 4}, 2, 1, kFree).tile));
  ASSERT_TRUE(map.add(Uniform(0.05, {-9, 7}, 1, 2, kOccupied).tile));
  ASSERT_TRUE(map.extent());
  EXPECT_EQ(map.extent()->first, Eigen::Vector2i(-9, 4));
  EXPECT_EQ(map.extent()->last, Eigen::Vector2i(4, 8));
  map.clear();
  EXPECT_FALSE(map.extent());
  EXPECT_TRUE(map.is_empty());
}

TEST(Map2d, RefusesWhatWouldTakeTooMuchMemoryOrTime) {
  Map2d map;
  EXPECT_FALSE(
      map.add(Uniform(std::numeric_limits<double>::quiet_NaN(), {0, 0}, 1, 1, kFree).tile));
  EXPECT_FALSE(map.add(Uniform(0.002, {0, 0}, 1, 1, kFree).tile));
  EXPECT_FALSE(map.add(Uniform(0.5, {0, 0}, 1, 1, kFree).tile));
  EXPECT_FALSE(map.add(Uniform(0.05, {0, 0}, 1024, 1024, kFree).tile));
  EXPECT_TRUE(map.is_empty());
  // 32 x 32 blocks are 205 m x 205 m.
  for (int block = 0; block < 32; ++block) {
    for (int beside = 0; beside < 32; ++beside) {
      ASSERT_TRUE(map.add(Uniform(0.05, {128 * beside, 128 * block}, 1, 1, kFree).tile));
    }
  }
  EXPECT_FALSE(map.add(Uniform(0.05, {-1, 0}, 1, 1, kFree).tile));
  EXPECT_TRUE(map.add(Uniform(0.05, {1, 0}, 1, 1, kOccupied).tile));
  EXPECT_EQ(at(map, -1, 0), Kind::kUnknown);
  EXPECT_EQ(at(map, 1, 0), Kind::kOccupied);
}

}  // namespace map_2d_test
}  // namespace nodmap::navigator
