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

}  // namespace holes_test
}  // namespace nodmap::navigator
