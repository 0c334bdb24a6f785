// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/holes.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace holes_test {

TEST(Holes, OneCertainBeamOrTwoInTwoScansMakeAHole) {
  LocalGrid grid(0.025, 9);
  grid.center_on({0.0, 0.0});
  const Eigen::Vector2d p(1.0, 0.5);
  grid.find(p)->set_floor();
  add_hole(grid, p, false, 1, 0);
  add_hole(grid, p, false, 1, 0);
  EXPECT_FALSE(grid.find(p)->is_hole());
  EXPECT_FALSE(grid.find(p)->is_floor);
  add_hole(grid, p, false, 2, 0);
  EXPECT_TRUE(grid.find(p)->is_hole());
  add_hole(grid, -p, true, 1, 0);
  EXPECT_TRUE(grid.find(-p)->is_hole());
  const Eigen::Vector2d both(1.0, -0.5);  // in one scan
  add_hole(grid, both, false, 1, 0);
  add_hole(grid, both, true, 1, 0);
  EXPECT_TRUE(grid.find(both)->is_hole());
  add_hole(grid, {1e6, 0.0}, true, 1, 0);  // outside the grid: ignored
}

TEST(Holes, APossibleRampIsNoHoleAndLeavesFloorAsItIs) {
  LocalGrid grid(0.025, 9);
  grid.center_on({0.0, 0.0});
  LocalCell& cell = *grid.find({1.0, 0.5});
  cell.set_floor();
  add_possible_ramp(grid, {1.0, 0.5});
  EXPECT_TRUE(cell.may_be_ramp);
  EXPECT_TRUE(cell.is_floor);
  EXPECT_FALSE(cell.is_hole());
  add_possible_ramp(grid, {1e6, 0.0});  // outside the grid: ignored
}

// A second cell at most two away says the same; a cell that is a hole is no ramp itself.
TEST(Holes, ASingleCellIsNoPossibleRampDown) {
  LocalGrid grid(0.025, 9);
  grid.center_on({0.0, 0.0});
  const Eigen::Vector2i index = grid.index_of({1.0, 0.5});
  grid.at(index).may_be_ramp = true;
  EXPECT_FALSE(is_possible_ramp_down(grid, index));
  const Eigen::Vector2i beside = index + Eigen::Vector2i(2, -2);
  grid.at(index + Eigen::Vector2i(3, 0)).may_be_ramp = true;
  EXPECT_FALSE(is_possible_ramp_down(grid, index));
  grid.at(beside).may_be_ramp = true;
  EXPECT_TRUE(is_possible_ramp_down(grid, index));
  grid.at(beside).hole = evidence::kMost;
  EXPECT_TRUE(is_possible_ramp_down(grid, index));
  EXPECT_FALSE(is_possible_ramp_down(grid, beside));
}

}  // namespace holes_test
}  // namespace nodmap::navigator
