// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/planning_grid.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace nodmap::explorer {
namespace planning_grid_test {

constexpr double kInflationRadiusM = 0.205;
constexpr int kTile = 40;

// A map whose cells are free unless set otherwise.
struct Map {
  explicit Map(Cell first_cell = Cell::Zero())
      : first(std::move(first_cell)), cells(kTile * kTile, 0) {}

  Map& set(int x, int y, std::int8_t occupancy) {
    cells[static_cast<std::size_t>(y * kTile + x)] = occupancy;
    return *this;
  }
  [[nodiscard]] MapTile tile() const { return {0.05, first, kTile, kTile, cells}; }

  Cell first;
  std::vector<std::int8_t> cells;
};

TEST(PlanningGrid, APlanningCellIsOccupiedFreeOrUnknownByItsFourMapCells) {
  Map map;
  for (int x = 0; x < kTile; ++x) {
    for (int y = 20; y < kTile; ++y) {
      map.set(x, y, -1);
    }
  }
  map.set(11, 10, 25).set(21, 10, 24).set(31, 30, 0);
  PlanningGrid grid(kInflationRadiusM);
  ASSERT_TRUE(grid.add(map.tile()));
  EXPECT_EQ(grid.cell_size_m(), 0.1);
  EXPECT_EQ(grid.ground_at({5, 5}), Ground::kOccupied);
  EXPECT_EQ(grid.ground_at({10, 5}), Ground::kFree) << "few rays ended here";
  EXPECT_EQ(grid.ground_at({15, 15}), Ground::kFree);
  EXPECT_EQ(grid.ground_at({5, 15}), Ground::kUnknown);
  EXPECT_EQ(grid.ground_at({-100, 15}), Ground::kUnknown);
  EXPECT_EQ(grid.num_free(), 20 * 10 - 1 + 1);
}

TEST(PlanningGrid, GapsOfOneCellBelongToTheCellsOnBothSides) {
  Map map;
  std::ranges::fill(map.cells, static_cast<std::int8_t>(-1));
  map.set(10, 10, 0).set(14, 10, 0);      // beams: cells 5 and 7 of row 5
  map.set(10, 20, 100).set(14, 24, 100);  // a wall across
  PlanningGrid grid(kInflationRadiusM);
  ASSERT_TRUE(grid.add(map.tile()));
  EXPECT_EQ(grid.ground_at({6, 5}), Ground::kFree);
  EXPECT_EQ(grid.ground_at({6, 11}), Ground::kOccupied);
  EXPECT_EQ(grid.ground_at({8, 5}), Ground::kUnknown);
}

// A wall seen at a grazing angle. Its ends are in two tiles: the second one changes cells of the
// first.
TEST(PlanningGrid, GapsOfUpToThreeCellsInAWallAreFilledAndThoseOfFourAreNot) {
  for (const int gap_cells : {1, 2, 3, 4}) {
    Map left(Cell(-kTile, 0));
    Map right;
    for (Map* map : {&left, &right}) {
      std::ranges::fill(map->cells, static_cast<std::int8_t>(-1));
    }
    for (int y = 0; y < kTile; y += 20) {
      left.set(kTile - 2 * gap_cells, y, 100);  // planning cell -gap_cells
      right.set(2, y, y == 20 ? 0 : 100);       // planning cell 1
    }
    PlanningGrid grid(kInflationRadiusM);
    ASSERT_TRUE(grid.add(left.tile()));
    ASSERT_TRUE(grid.add(right.tile()));
    for (int x = 1 - gap_cells; x < 1; ++x) {
      EXPECT_EQ(grid.ground_at({x, 0}), gap_cells <= 3 ? Ground::kOccupied : Ground::kUnknown)
          << "gap of " << gap_cells << ", cell " << x;
      EXPECT_EQ(grid.ground_at({x, 10}), Ground::kUnknown) << "a wall on one side only";
    }
  }
}

// Oracle: looks at all cells.
bool is_passable(const std::vector<Map>& maps, const PlanningGrid& grid, const Cell& cell) {
  bool has_room = false;
  for (int i = 0; i < 4; ++i) {
    const Cell map_cell = 2 * cell + Cell(i % 2, i / 2);
    bool is_near = false;
    for (const Map& map : maps) {
      for (int at = 0; at < kTile * kTile; ++at) {
        const Cell other = map.first + Cell(at % kTile, at / kTile);
        is_near = is_near || (map.cells[static_cast<std::size_t>(at)] >= 25 &&
                              0.05 * (other - map_cell).cast<double>().norm() < kInflationRadiusM);
      }
    }
    has_room = has_room || !is_near;
  }
  return has_room && grid.ground_at(cell) == Ground::kFree;
}

// The grid follows a changing map; the oracle recomputes everything.
TEST(PlanningGrid, PassableCellsAreFarEnoughFromAllOccupiedOnes) {
  std::mt19937_64 engine(1000);
  std::uniform_int_distribution<int> place(0, kTile - 1);
  std::vector<Map> maps{Map(Cell(-kTile, 0)), Map(Cell(0, 0))};
  PlanningGrid grid(kInflationRadiusM);
  for (int round = 0; round < 4; ++round) {
    for (Map& map : maps) {
      std::ranges::fill(map.cells, static_cast<std::int8_t>(0));
      for (int i = 0; i < 6; ++i) {
        map.set(place(engine), place(engine), 100);
      }
      ASSERT_TRUE(grid.add(map.tile()));
    }
    int num_passable = 0;
    for (int y = 0; y < kTile / 2; ++y) {
      for (int x = -kTile / 2; x < kTile / 2; ++x) {
        ASSERT_EQ(grid.is_passable({x, y}), is_passable(maps, grid, {x, y})) << x << ", " << y;
        num_passable += grid.is_passable({x, y}) ? 1 : 0;
      }
    }
    EXPECT_GT(num_passable, 100);
    EXPECT_LT(num_passable, kTile / 2 * kTile);
  }
}

TEST(PlanningGrid, InvalidTilesAreRefused) {
  const Map map;
  PlanningGrid grid(kInflationRadiusM);
  MapTile tile = map.tile();
  tile.width = kTile + 1;
  EXPECT_FALSE(grid.add(tile));
  tile = map.tile();
  for (const double cell_size_m : {0.0, 0.002, std::numeric_limits<double>::quiet_NaN()}) {
    tile.cell_size_m = cell_size_m;
    EXPECT_FALSE(grid.add(tile)) << cell_size_m;
  }
  tile = map.tile();
  tile.first = Cell(2'000'000, 0);
  EXPECT_FALSE(grid.add(tile));
  ASSERT_TRUE(grid.add(map.tile()));
  tile.first = Cell(30'000, 30'000);  // possible on its own
  EXPECT_FALSE(grid.add(tile));
  EXPECT_EQ(grid.num_free(), kTile * kTile / 4);
}

TEST(PlanningGrid, AnotherCellSizeIsThatOfAnotherMap) {
  Map map;
  map.set(10, 10, 100);
  PlanningGrid grid(kInflationRadiusM);
  ASSERT_TRUE(grid.add(map.tile()));
  const std::int64_t num_free = grid.num_free();
  MapTile tile = map.tile();
  tile.cell_size_m = 0.1;
  tile.first = Cell(100, 100);
  EXPECT_FALSE(grid.add(tile));
  EXPECT_EQ(grid.num_free(), num_free);
  grid.clear();
  ASSERT_TRUE(grid.add(tile));
  EXPECT_EQ(grid.ground_at({5, 5}), Ground::kUnknown);
  EXPECT_EQ(grid.ground_at({55, 55}), Ground::kOccupied);
  EXPECT_EQ(grid.cell_size_m(), 0.2);
}

}  // namespace planning_grid_test
}  // namespace nodmap::explorer
