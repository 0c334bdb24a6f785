// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/rolling_grid.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace rolling_grid_test {

TEST(RollingGrid, CellsKeepTheirPlaceInOdomAndNewOnesAreEmpty) {
  RollingGrid<int> grid(0.1, 5);
  grid.center_on({0.0, 0.0});
  grid.at(grid.index_of({0.55, -0.35})) = 7;
  for (double x = 0.0; x < 2.0; x += 0.13) {
    grid.center_on({x, 0.5 * x});
    const Eigen::Vector2i index = grid.index_of({0.55, -0.35});
    EXPECT_EQ(grid.at(index), grid.contains(index) ? 7 : 0);
  }
  grid.center_on({4.0, 0.0});
  grid.center_on({0.0, 0.0});
  EXPECT_EQ(grid.at(grid.index_of({0.55, -0.35})), 0);
}

}  // namespace rolling_grid_test
}  // namespace nodmap::navigator
