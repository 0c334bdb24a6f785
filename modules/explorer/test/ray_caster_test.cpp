// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/ray_caster.hpp"

#include <gtest/gtest.h>

#include <set>

namespace nodmap::explorer {
namespace ray_caster_test {

constexpr int kCells = 400;  // of the map: 20 m x 20 m, the origin in its middle

// Unknown ground with a free rectangle and occupied ones, in map cells.
struct Scene {
  Scene() : cells(kCells * kCells, -1) {}
  void fill(double x_min, double y_min, double x_max, double y_max, std::int8_t occupancy) {
    for (int y = static_cast<int>(20.0 * y_min) + 200; y < static_cast<int>(20.0 * y_max) + 200;
         ++y) {
      for (int x = static_cast<int>(20.0 * x_min) + 200; x < static_cast<int>(20.0 * x_max) + 200;
           ++x) {
        cells[static_cast<std::size_t>(y * kCells + x)] = occupancy;
      }
    }
  }
  [[nodiscard]] PlanningGrid grid() const {
    PlanningGrid grid(0.2);
    EXPECT_TRUE(grid.add({0.05, Cell(-200, -200), kCells, kCells, cells}));
    return grid;
  }
  std::vector<std::int8_t> cells;
};

double seen_m2(const PlanningGrid& grid, const ViewParams& params, double heading_rad) {
  RayCaster caster(params, 0.0);
  const auto& cells = caster.unknown_cells(grid, {0.0, 0.0}, heading_rad);
  EXPECT_EQ(std::set<std::uint32_t>(cells.begin(), cells.end()).size(), cells.size());
  return 0.01 * static_cast<double>(cells.size());
}

// Nothing is known: the beams cover a half disc whose radius is the depth that a beam may pass
// through.
TEST(RayCaster, UnknownGroundIsSeenUpToTheDepthThatABeamMayPass) {
  Scene scene;
  scene.fill(-0.1, -0.1, 0.1, 0.1, 0);
  ViewParams params;
  params.unknown_depth_m = 3.0;
  // Tolerance: cells of 10 cm along the border of the half disc, 15.4 m long; half of them, half a
  // cell wide.
  EXPECT_NEAR(seen_m2(scene.grid(), params, 0.3), 0.5 * 3.1 * 3.1 * geometry::kPi, 0.4);
}

// A wall with a gap of 1 m, one metre ahead: a wedge behind it is visible.
TEST(RayCaster, CellsBehindAWallAreHidden) {
  Scene scene;
  scene.fill(-2.0, -3.0, 1.0, 3.0, 0);
  scene.fill(1.0, -9.0, 1.1, 9.0, 100);
  ViewParams params;
  params.range_m = 5.0;
  params.unknown_depth_m = 50.0;
  // Wider beams would leave the free rectangle at its sides and see unknown cells in front of the
  // wall.
  params.half_angle_rad = geometry::deg_to_rad(60.0);
  const double walled = seen_m2(scene.grid(), params, 0.0);
  EXPECT_EQ(walled, 0.0);
  scene.fill(1.0, -0.5, 1.1, 0.5, 0);
  const double half_angle_rad = std::atan2(0.5, 1.05);
  const double wedge_m2 = half_angle_rad * 25.0 - std::tan(half_angle_rad) * 1.1 * 1.1;
  // Tolerance: cells of 10 cm along the border of the wedge, 14 m long, half a cell wide, are 7 %
  // of its area.
  EXPECT_NEAR(seen_m2(scene.grid(), params, 0.0) / wedge_m2, 1.0, 0.07);
}

// A wall at 45 degrees whose cells touch at their corners, 1.4 m ahead. What is behind it is
// unknown.
TEST(RayCaster, NothingIsSeenThroughAClosedCorner) {
  constexpr int kWall = 20;  // planning cells with x + y = 20
  Scene scene;
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) {
      const int sum = (x - 200) / 2 + (y - 200) / 2;
      if (x >= 200 - 40 && y >= 200 - 40 && sum <= kWall) {
        scene.cells[static_cast<std::size_t>(y * kCells + x)] = sum == kWall ? 100 : 0;
      }
    }
  }
  ViewParams params;
  params.half_angle_rad = geometry::deg_to_rad(40.0);
  const PlanningGrid grid = scene.grid();
  ASSERT_EQ(grid.ground_at({10, 10}), Ground::kOccupied);
  ASSERT_EQ(grid.ground_at({11, 10}), Ground::kUnknown);
  EXPECT_EQ(seen_m2(grid, params, geometry::deg_to_rad(45.0)), 0.0);
}

TEST(RayCaster, OnlyTheLasersFieldOfViewIsSeen) {
  Scene scene;
  scene.fill(-10.0, -10.0, 1.0, 10.0, 0);
  ViewParams params;
  EXPECT_GT(seen_m2(scene.grid(), params, 0.0), 5.0);
  EXPECT_EQ(seen_m2(scene.grid(), params, geometry::kPi), 0.0);
}

}  // namespace ray_caster_test
}  // namespace nodmap::explorer
