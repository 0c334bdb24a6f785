// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/floor_evidence.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace floor_evidence_test {

// The floor after two scans of two beams each, which hit it at the corners of a rectangle.
LocalGrid floor_between(double length_m, double width_m) {
  LocalGrid grid(0.025, 9);
  grid.center_on({0.0, 0.0});
  FloorEvidence floor(LocalMapParams{});
  for (std::uint16_t scan = 1; scan <= 2; ++scan) {
    const double x = 1.0 + length_m * (scan - 1);
    floor.begin_scan(2);
    floor.add(grid, 0, {x, 0.0}, 0.0, scan);
    floor.add(grid, 1, {x, width_m}, 0.0, scan);
    floor.end_scan(grid, scan);
  }
  return grid;
}

TEST(FloorEvidence, FillsTheFloorBetweenFourBeams) {
  const LocalGrid grid = floor_between(0.14, 0.1);
  for (double x = 1.0; x <= 1.14; x += 0.01) {
    for (double y = 0.0; y <= 0.1; y += 0.01) {
      EXPECT_TRUE(grid.find({x, y})->is_floor) << x << ' ' << y;
    }
  }
  EXPECT_FALSE(grid.find({0.97, 0.05})->is_floor);
  EXPECT_FALSE(grid.find({1.17, 0.05})->is_floor);
}

TEST(FloorEvidence, LeavesAGapThatIsWiderThanAllowed) {
  EXPECT_FALSE(floor_between(0.16, 0.1).find({1.08, 0.05})->is_floor);
  EXPECT_TRUE(floor_between(0.16, 0.1).find({1.0, 0.05})->is_floor);  // in one scan
  EXPECT_FALSE(floor_between(0.16, 0.16).find({1.0, 0.08})->is_floor);
}

TEST(FloorEvidence, DoesNotFillTheFloorBetweenScansWithoutCommonBeams) {
  LocalGrid grid(0.025, 9);
  grid.center_on({0.0, 0.0});
  FloorEvidence floor(LocalMapParams{});
  for (std::uint16_t scan = 1; scan <= 2; ++scan) {
    floor.forget_last_scan();
    floor.begin_scan(2);
    floor.add(grid, 0, {0.9 + 0.1 * scan, 0.0}, 0.0, scan);
    floor.add(grid, 1, {0.9 + 0.1 * scan, 0.1}, 0.0, scan);
    floor.end_scan(grid, scan);
  }
  EXPECT_TRUE(grid.find({1.0, 0.05})->is_floor);
  EXPECT_FALSE(grid.find({1.05, 0.05})->is_floor);
}

// Two lines meet the floor 10 cm apart, and a beam has passed through the floor between them. Only
// lines so close together that they count against a hole do so against a possible ramp.
TEST(FloorEvidence, LinesFarApartSayNothingOfAPossibleRampBetweenThem) {
  for (const double gap_m : {0.1, 0.04}) {
    LocalGrid grid(0.025, 9);
    grid.center_on({0.0, 0.0});
    LocalCell& between = *grid.find({1.0, 0.02});
    between.may_be_ramp = true;
    FloorEvidence floor(LocalMapParams{});
    std::uint16_t scan = 1;
    for (const double x : {1.0 - 0.5 * gap_m, 1.0 + 0.5 * gap_m}) {
      floor.begin_scan(2);
      floor.add(grid, 0, {x, 0.0}, 0.0, scan);
      floor.add(grid, 1, {x, 0.04}, 0.0, scan);
      floor.end_scan(grid, scan);
      ++scan;
    }
    EXPECT_TRUE(between.is_floor);
    EXPECT_EQ(between.may_be_ramp, gap_m > 0.05) << gap_m;
  }
}

// Floor seen where an obstacle was measured counts against the obstacle; floor seen below a table
// top does not count against the table.
TEST(FloorEvidence, CountsAgainstObstaclesOnTheFloorOnly) {
  LocalGrid grid(0.025, 9);
  grid.center_on({0.0, 0.0});
  LocalCell& box = *grid.find({1.0, 0.0});
  LocalCell& table = *grid.find({1.0, 0.1});
  box.obstacle = table.obstacle = evidence::kCertain;
  box.low_cm = 3;
  table.low_cm = 30;
  FloorEvidence floor(LocalMapParams{});
  floor.begin_scan(2);
  floor.add(grid, 0, {1.0, 0.0}, 0.0, 1);
  floor.add(grid, 1, {1.0, 0.1}, 0.0, 1);
  EXPECT_EQ(box.obstacle, evidence::kCertain - 1);
  EXPECT_EQ(table.obstacle, evidence::kCertain);
}

}  // namespace floor_evidence_test
}  // namespace nodmap::navigator
