// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/waypoints.hpp"

#include <gtest/gtest.h>

namespace nodmap::explorer {
namespace waypoints_test {

constexpr double kToleranceM = 0.3;
constexpr double kLastToleranceM = 0.05;
constexpr int kMapCells = 240;  // 12 m x 12 m, the origin in its middle

// Free ground, with a wall along y at x = 3 m from `wall_from_m` on, 0.1 m thick.
PlanningGrid ground_with_wall(double wall_from_m) {
  std::vector<std::int8_t> cells(kMapCells * kMapCells, 0);
  for (int y = static_cast<int>(20.0 * (wall_from_m + 6.0)); y < kMapCells; ++y) {
    for (int x = 180; x < 182; ++x) {
      cells[static_cast<std::size_t>(y * kMapCells + x)] = 100;
    }
  }
  PlanningGrid grid(0.2);
  EXPECT_TRUE(grid.add({0.05, {-120, -120}, kMapCells, kMapCells, cells}));
  return grid;
}

std::vector<Viewpoint> tour_over(const std::vector<Eigen::Vector2d>& places) {
  std::vector<Viewpoint> tour;
  for (const Eigen::Vector2d& p_map : places) {
    tour.push_back({.p_map = p_map});
  }
  return tour;
}

TEST(NumOnLine, CountsTheViewpointsOfAPassableStraightLineInTheirOrder) {
  const PlanningGrid open = ground_with_wall(6.0);
  const Eigen::Vector2d from = Eigen::Vector2d::Zero();
  const auto num = [&](const PlanningGrid& grid, const std::vector<Eigen::Vector2d>& places) {
    return num_on_line(grid, tour_over(places), from, kToleranceM);
  };
  EXPECT_EQ(num(open, {{2.0, 0.0}}), 1U);
  EXPECT_EQ(num(open, {{2.0, 0.0}, {3.5, 0.2}, {5.0, 0.0}}), 3U);
  EXPECT_EQ(num(open, {{2.0, 0.0}, {5.0, 0.0}, {3.5, 0.0}}), 2U) << "not in this order";
  EXPECT_EQ(num(open, {{2.0, 0.31}, {5.0, 0.0}}), 1U) << "too far from the line";
  EXPECT_EQ(num(open, {{2.0, 0.0}, {-2.0, 0.0}}), 1U) << "behind";
  EXPECT_EQ(num(open, {{2.0, 0.0}, {2.0, 0.0}}), 2U);
  EXPECT_EQ(num(ground_with_wall(-6.0), {{2.0, 0.0}, {2.5, 0.0}, {5.0, 0.0}}), 2U);
}

TEST(LinePassable, IsFalseForAWallAndForUnknownGround) {
  const PlanningGrid grid = ground_with_wall(0.0);
  EXPECT_TRUE(is_line_passable(grid, {0.0, 0.0}, {2.7, 0.0}));
  EXPECT_FALSE(is_line_passable(grid, {0.0, 0.0}, {5.0, 0.0}));
  EXPECT_TRUE(is_line_passable(grid, {0.0, -1.0}, {5.0, -1.0}));
  EXPECT_FALSE(is_line_passable(grid, {0.0, -1.0}, {8.0, -1.0}));
  EXPECT_TRUE(is_line_passable(grid, {2.8, 1.0}, {2.0, 1.0})) << "it starts close to the wall";
}

// From the origin around the end of the wall at (3, 0) to (4, 2).
std::vector<Eigen::Vector2d> path_around_the_wall(double from_m) {
  std::vector<Eigen::Vector2d> path;
  for (double x = from_m; x < 4.0; x += 0.1) {
    path.emplace_back(x, -0.5);
  }
  for (double y = -0.5; y <= 2.0; y += 0.1) {
    path.emplace_back(4.0, y);
  }
  return path;
}

TEST(Waypoints, LeadAroundACornerToTheEndWithoutAHalt) {
  const PlanningGrid grid = ground_with_wall(0.0);
  Waypoints dut(kToleranceM);
  std::vector<Eigen::Vector2d> places{{0.0, -0.5}};
  const Goal first = dut.next(grid, path_around_the_wall(0.0), places[0], kLastToleranceM);
  EXPECT_EQ(first.tolerance_m, kToleranceM);
  EXPECT_TRUE(is_line_passable(grid, places[0], first.p_map));
  EXPECT_GT(first.p_map.x(), 3.0);
  // Kept until it is 1.2 m away, as far as the robot brakes for it.
  const double last_kept_m = first.p_map.x() - 1.3;
  for (double x = 0.1; x < last_kept_m; x += 0.1) {
    const Goal same = dut.next(grid, path_around_the_wall(x), {x, -0.5}, kLastToleranceM);
    ASSERT_EQ(same.p_map, first.p_map) << x;
  }
  const Goal end = dut.next(grid, path_around_the_wall(3.8), {3.8, -0.5}, kLastToleranceM);
  EXPECT_EQ(end.p_map, path_around_the_wall(0.0).back());
  EXPECT_EQ(end.tolerance_m, kLastToleranceM);
}

TEST(Waypoints, AreAheadEvenAroundACorner) {
  const PlanningGrid grid = ground_with_wall(-6.0);  // nothing behind it is visible
  Waypoints dut(kToleranceM);
  const std::vector<Eigen::Vector2d> path = path_around_the_wall(2.6);
  const Goal goal = dut.next(grid, path, path.front(), kLastToleranceM);
  // 0.5 m, less the distance from one point of the path to the next.
  EXPECT_GT((goal.p_map - path.front()).norm(), kToleranceM + 0.5 - 0.1);
}

// The path's end is 0.6 m away, behind the wall.
TEST(Waypoints, AreNotBehindAWallThatThePathLeadsAround) {
  const PlanningGrid grid = ground_with_wall(0.0);
  Waypoints dut(kToleranceM);
  std::vector<Eigen::Vector2d> path;
  for (double y = 1.0; y > -0.5; y -= 0.1) {
    path.emplace_back(2.75, y);
  }
  for (double x = 2.75; x < 3.35; x += 0.1) {
    path.emplace_back(x, -0.5);
  }
  for (double y = -0.5; y <= 1.0; y += 0.1) {
    path.emplace_back(3.35, y);
  }
  const Goal goal = dut.next(grid, path, path.front(), kLastToleranceM);
  EXPECT_LT(goal.p_map.x(), 3.0);
  EXPECT_LT(goal.p_map.y(), 0.3);
}

TEST(Waypoints, AnotherPathBringsAnotherWaypoint) {
  const PlanningGrid grid = ground_with_wall(6.0);
  Waypoints dut(kToleranceM);
  const std::vector<Eigen::Vector2d> ahead{{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}};
  const std::vector<Eigen::Vector2d> aside{{0.0, 0.0}, {0.0, 1.0}, {0.0, 2.0}};
  EXPECT_EQ(dut.next(grid, ahead, {0.0, 0.0}, kLastToleranceM).p_map, ahead.back());
  EXPECT_EQ(dut.next(grid, aside, {0.0, 0.0}, kLastToleranceM).p_map, aside.back());
}

}  // namespace waypoints_test
}  // namespace nodmap::explorer
