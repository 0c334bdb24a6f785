// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/local_view.hpp"

#include <gtest/gtest.h>

#include <random>

#include "modules/navigator/local_map/holes.hpp"

namespace nodmap::navigator {
namespace local_view_test {

// A grid with some obstacles, old and new, and some holes, up to its border.
LocalGrid cluttered(const ObstacleMemory& memory) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> kind(0, 39);
  LocalGrid grid(0.025, 6);
  grid.center_on({-3.0, 7.0});
  for (int row = 0; row < grid.size(); ++row) {
    for (int column = 0; column < grid.size(); ++column) {
      const Eigen::Vector2i index = grid.first() + Eigen::Vector2i(column, row);
      switch (kind(random)) {
        case 0:
          add_hole(grid, grid.center_of(index), true, 1, memory.travel_dm());
          break;
        case 1:
          grid.at(index).obstacle = evidence::kMost;
          grid.at(index).seen_at_dm = memory.travel_dm();
          break;
        case 2:
          grid.at(index).obstacle = evidence::kMost;  // at travel 0: forgotten by now
          break;
        case 3:
          grid.at(index).obstacle = evidence::kEnough - 1;
          break;
        case 4:
          grid.at(index).scan = 1;
          break;
        default:
          grid.at(index).set_floor();
      }
    }
  }
  return grid;
}

// Oracle: a cell is the edge of a hole if the cell two beside it, on any of its sides, is a hole.
bool is_edge_of_hole(const LocalGrid& grid, const Eigen::Vector2i& index) {
  const auto is_hole = [&](int dx, int dy) {
    const Eigen::Vector2i at = index + Eigen::Vector2i(dx, dy);
    return grid.contains(at) && grid.at(at).is_hole();
  };
  return is_hole(2, 0) || is_hole(-2, 0) || is_hole(0, 2) || is_hole(0, -2);
}

// Oracle: each cell by the definition, within the grid, across its border and outside.
TEST(LocalView, EqualsTheDefinitionCellByCell) {
  ObstacleMemory memory(1.0);
  memory.move({}, {5.0, 0.0, 0.0});
  const LocalGrid grid = cluttered(memory);
  const Eigen::Vector2i middle_of_grid = grid.first() + Eigen::Vector2i::Constant(32);
  for (const int aside : {0, 30, 200}) {
    const Eigen::Vector2i middle = middle_of_grid + Eigen::Vector2i(aside, -aside / 2);
    const int reach = 12;
    const LocalView view(grid, memory, middle, reach);
    unsigned all = 0;
    for (int dy = -reach - 2; dy <= reach + 2; ++dy) {
      for (int dx = -reach - 2; dx <= reach + 2; ++dx) {
        const Eigen::Vector2i index = middle + Eigen::Vector2i(dx, dy);
        unsigned expected = 0;
        if (std::max(std::abs(dx), std::abs(dy)) <= reach && grid.contains(index)) {
          const LocalCell& cell = grid.at(index);
          const bool is_forgotten = cell.is_obstacle() && memory.is_forgotten(cell);
          const bool is_blocked = cell.is_hole() || is_edge_of_hole(grid, index) ||
                                  (cell.is_obstacle() && !is_forgotten);
          expected = (cell.is_floor ? LocalView::kFloor : 0U) |
                     (is_blocked ? LocalView::kBlocked : 0U) |
                     (is_forgotten ? LocalView::kForgotten : 0U) |
                     (cell.is_cleared() ? LocalView::kCleared : 0U);
        }
        EXPECT_EQ(view.at(index), expected) << aside << ' ' << dx << ' ' << dy;
        const Eigen::Vector2d p_odom = grid.center_of(index) + Eigen::Vector2d(0.012, -0.012);
        EXPECT_EQ(view.at(view.in_cells(p_odom)), expected) << aside << ' ' << dx << ' ' << dy;
        all |= expected;
      }
    }
    EXPECT_EQ(all, aside < 100 ? 15U : 0U);
  }
}

}  // namespace local_view_test
}  // namespace nodmap::navigator
