// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/seen_floor.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace seen_floor_test {

constexpr double kCellM = 0.025;
const robot::Footprint kBody{0.225, 0.165};
constexpr double kBlindM = 0.31;  // no row of the front lies on a border of cells
const ObstacleMemory kObstacles(20.0);

// A grid of floor, except for a strip across the way ahead or behind.
LocalGrid floor_without(double from_x, double to_x) {
  LocalGrid grid(kCellM, 8);
  grid.center_on({0.0, 0.0});
  for (double x = -3.0; x < 3.0; x += 0.5 * kCellM) {
    for (double y = -1.0; y < 1.0; y += 0.5 * kCellM) {
      grid.find({x, y})->is_floor = x < from_x || x > to_x;
    }
  }
  return grid;
}

// Floor is seen up to the beginning of the strip. The robot's front is at 0.225 m, and floor counts
// from 0.31 m.
TEST(SeenFloor, EndsWhereAGapIsLongerThanAllowed) {
  const LocalGrid grid = floor_without(1.3, 1.55);
  const SeenFloor floor(grid, kObstacles, kBody, kBlindM);
  EXPECT_NEAR(floor.distance({}, 0.0, 2.0, 0.15, false), 1.3 - kBlindM, kCellM);
  EXPECT_EQ(floor.distance({}, 0.0, 2.0, 0.35, false), 2.0);
  EXPECT_EQ(floor.distance({}, 0.0, 0.5, 0.15, false), 0.5);
}

// Columns are 4 cm apart. A single one may lie between beams; two are a hole that a wheel falls
// into.
TEST(SeenFloor, TwoColumnsWithoutFloorEndItAndOneDoesNot) {
  for (const double until_y : {0.05, 0.1}) {
    LocalGrid grid = floor_without(10.0, 10.0);
    for (double x = 1.0; x < 3.0; x += 0.5 * kCellM) {
      for (double y = 0.03; y < until_y; y += 0.5 * kCellM) {
        grid.find({x, y})->is_floor = false;
      }
    }
    const double seen_m =
        SeenFloor(grid, kObstacles, kBody, kBlindM).distance({}, 0.0, 2.0, 0.15, false);
    EXPECT_NEAR(seen_m, until_y == 0.05 ? 2.0 : 1.0 - kBlindM, kCellM) << until_y;
  }
}

// A wall across the way ahead; two cells thick, as with the laser's noise.
void add_wall(LocalGrid& grid, double x) {
  for (double y = -1.0; y < 1.0; y += 0.5 * kCellM) {
    grid.find({x, y})->obstacle = evidence::kMost;
    grid.find({x + kCellM, y})->obstacle = evidence::kMost;
  }
}

// The robot's front is at 0.225 m. Floor counts from 0.31 m. An obstacle before 0.36 m hides the
// ground behind it.
TEST(SeenFloor, GroundBehindAnObstacleNearerThanAllSeenFloorDoesNotCountAsUnknown) {
  for (const double wall_m : {0.28, 0.34}) {
    LocalGrid grid = floor_without(wall_m - 0.01, 3.0);
    EXPECT_LT(SeenFloor(grid, kObstacles, kBody, kBlindM).distance({}, 0.0, 0.5, 0.15, true), 0.06);
    add_wall(grid, wall_m);
    EXPECT_EQ(SeenFloor(grid, kObstacles, kBody, kBlindM).distance({}, 0.0, 0.5, 0.15, true), 0.5);
    EXPECT_LT(SeenFloor(grid, kObstacles, kBody, kBlindM).distance({}, 0.0, 0.5, 0.15, false),
              0.06);
  }
}

TEST(SeenFloor, GroundBehindAFartherObstacleCountsAsUnknown) {
  LocalGrid grid = floor_without(0.41, 3.0);
  add_wall(grid, 0.42);
  EXPECT_NEAR(SeenFloor(grid, kObstacles, kBody, kBlindM).distance({}, 0.0, 0.5, 0.15, true),
              0.41 - kBlindM, kCellM);
}

TEST(SeenFloor, AForgottenObstacleCountsAsUnknown) {
  LocalGrid grid = floor_without(0.27, 3.0);
  add_wall(grid, 0.28);
  ObstacleMemory obstacles(20.0);
  obstacles.move({}, {21.0, 0.0, 0.0});
  EXPECT_EQ(SeenFloor(grid, obstacles, kBody, kBlindM).distance({}, 0.0, 0.5, 0.15, true), 0.0);
}

TEST(SeenFloor, BackwardsAnyGapEndsTheSeenFloor) {
  const LocalGrid grid = floor_without(-0.5, -0.4);
  const SeenFloor floor(grid, kObstacles, kBody, kBlindM);
  EXPECT_NEAR(floor.distance_backwards({}, 0.0, 0.3), 0.4 - 0.225, kCellM);
  EXPECT_EQ(floor.distance_backwards({}, 0.0, 0.1), 0.1);
}

TEST(SeenFloor, BackwardsAssumedFloorDoesNotCount) {
  LocalGrid grid = floor_without(10.0, 10.0);
  for (double x = -1.0; x < 0.0; x += 0.5 * kCellM) {
    for (double y = -1.0; y < 1.0; y += 0.5 * kCellM) {
      grid.find({x, y})->is_assumed = true;
    }
  }
  EXPECT_EQ(SeenFloor(grid, kObstacles, kBody, kBlindM).distance_backwards({}, 0.0, 0.3), 0.0);
}

TEST(SeenFloor, IsAroundIsTrueOnFloorAndIsNearUpToACellBesideIt) {
  const LocalGrid grid = floor_without(1.0, 2.0);
  const SeenFloor floor(grid, kObstacles, kBody, kBlindM);
  EXPECT_TRUE(floor.is_around({0.9, 0.0}));
  EXPECT_FALSE(floor.is_around({1.01, 0.0}));
  EXPECT_TRUE(floor.is_near(grid.index_of({1.04, 0.0})));
  EXPECT_FALSE(floor.is_near(grid.index_of({1.07, 0.0})));
}

}  // namespace seen_floor_test
}  // namespace nodmap::navigator
