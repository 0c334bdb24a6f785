// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/shortest_paths.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

#include "modules/explorer/test/grid_world.hpp"

namespace nodmap::explorer {
namespace shortest_paths_test {

// A hall of 6 m x 4 m with pillars, all of it known.
PlanningGrid hall(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_int_distribution<std::size_t> column(0, 119);
  std::uniform_int_distribution<std::size_t> row(0, 79);
  std::vector<std::int8_t> cells(120 * 80, 0);
  for (int i = 0; i < 40; ++i) {
    const std::size_t x = column(engine);
    cells[row(engine) * 120 + x] = 100;
  }
  PlanningGrid grid(0.16);
  EXPECT_TRUE(grid.add({0.05, {0, 0}, 120, 80, cells}));
  return grid;
}

// Oracle: Bellman-Ford, which relaxes all edges until nothing changes. Lengths are in fifths of a
// cell.
std::vector<std::vector<double>> all_lengths(const PlanningGrid& grid, const Cell& from) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> lengths(40, std::vector<double>(60, kNever));
  lengths[static_cast<std::size_t>(from.y())][static_cast<std::size_t>(from.x())] = 0.0;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (int i = 0; i < 60 * 40 * 9; ++i) {
      const Cell a(i / 9 % 60, i / 9 / 60);
      const Cell b = a + Cell(i % 3 - 1, i % 9 / 3 - 1);
      if (b.x() < 0 || b.y() < 0 || b.x() >= 60 || b.y() >= 40 || !grid.is_passable(a) ||
          !grid.is_passable(b)) {
        continue;
      }
      double& length = lengths[static_cast<std::size_t>(b.y())][static_cast<std::size_t>(b.x())];
      const double by_a =
          lengths[static_cast<std::size_t>(a.y())][static_cast<std::size_t>(a.x())] +
          ((b - a).cwiseAbs().sum() == 2 ? 7.0 : 5.0);
      if (by_a < length) {
        length = by_a;
        has_changed = true;
      }
    }
  }
  return lengths;
}

TEST(ShortestPaths, LengthsAreThoseOfBellmanFordAndOfThePaths) {
  for (std::uint64_t seed = 1000; seed < 1003; ++seed) {
    const PlanningGrid grid = hall(seed);
    ShortestPaths paths;
    paths.compute(grid, {5.5, 3.5});
    ASSERT_FALSE(paths.cells().empty());
    const auto expected = all_lengths(grid, paths.cells().front());
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 60; ++x) {
        const double steps = expected[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
        // A fifth of a cell is 2 cm.
        ASSERT_NEAR(std::min(1e6, paths.length_m({x, y})), std::min(1e6, 0.02 * steps), 1e-9);
      }
    }
    const Cell far = paths.cells().back();
    const std::vector<Cell> path = paths.path_to(far);
    double length_m = 0.0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      ASSERT_TRUE(grid.is_passable(path[i]));
      ASSERT_LE((path[i] - path[i - 1]).cwiseAbs().maxCoeff(), 1);
      length_m += (path[i] - path[i - 1]).cwiseAbs().sum() == 2 ? 0.14 : 0.1;
    }
    EXPECT_NEAR(length_m, paths.length_m(far), 1e-9);
    EXPECT_EQ(path.front(), paths.cells().front());
  }
}

TEST(ShortestPaths, EndsWhenItsTargetsAreReached) {
  const PlanningGrid grid = hall(1000);
  ShortestPaths all;
  all.compute(grid, {5.5, 3.5});
  const std::vector<Cell> targets{all.cells()[10], all.cells()[50]};
  ShortestPaths paths;
  paths.compute(grid, {5.5, 3.5}, targets);
  EXPECT_LT(paths.cells().size(), 100U);
  for (const Cell& target : targets) {
    EXPECT_EQ(paths.length_m(target), all.length_m(target));
  }
}

TEST(ShortestPaths, WithoutRoomAroundTheRobotNothingIsReached) {
  const PlanningGrid grid = hall(1000);
  ShortestPaths paths;
  paths.compute(grid, {50.0, 50.0});
  EXPECT_TRUE(paths.cells().empty());
  EXPECT_FALSE(paths.is_reached({55, 35}));
  paths.compute(PlanningGrid(0.2), {0.0, 0.0});
  EXPECT_TRUE(paths.cells().empty());
}

TEST(ShortestPaths, TheHeadingIsThatAtTheEndOfThePath) {
  const PlanningGrid grid = hall(1000);
  ShortestPaths paths;
  paths.compute(grid, {5.0, 3.5});
  EXPECT_NEAR(paths.heading_rad(grid.cell_of({5.85, 3.5}), 2.0), 0.0, 1e-9);
  EXPECT_EQ(paths.heading_rad(paths.cells().front(), 2.0), 2.0);
}

}  // namespace shortest_paths_test
}  // namespace nodmap::explorer
