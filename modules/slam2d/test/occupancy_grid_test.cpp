// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace nodmap::slam2d {
namespace {

constexpr double kCell = 0.1;

std::int8_t occupancy_at(const OccupancyGrid& grid, double x_m, double y_m) {
  const Eigen::Vector2d place = (Eigen::Vector2d(x_m, y_m) - grid.origin()) / kCell;
  return grid.occupancy(static_cast<int>(std::floor(place.x())),
                        static_cast<int>(std::floor(place.y())));
}

TEST(OccupancyGrid, ARayFreesItsWayAndEndsInAWall) {
  OccupancyGrid grid(kCell);
  ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {1.05, 0.05}));
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(occupancy_at(grid, 0.05 + 0.1 * i, 0.05), 0);
  }
  EXPECT_EQ(occupancy_at(grid, 1.05, 0.05), 100);
  EXPECT_EQ(occupancy_at(grid, 1.15, 0.05), OccupancyGrid::kUnknown);
  EXPECT_EQ(occupancy_at(grid, 0.55, 0.15), OccupancyGrid::kUnknown);
}

TEST(OccupancyGrid, OccupancyIsTheShareOfRaysThatEnded) {
  OccupancyGrid grid(kCell);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {2.05, 0.05}));
  }
  ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {1.05, 0.05}));
  EXPECT_EQ(occupancy_at(grid, 1.05, 0.05), 25);
}

TEST(OccupancyGrid, RaysAgreeWithDenseSampling) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d eye(coordinate(random), coordinate(random));
    const Eigen::Vector2d end(coordinate(random), coordinate(random));
    OccupancyGrid grid(kCell);
    ASSERT_TRUE(grid.add_ray(eye, end));
    EXPECT_EQ(occupancy_at(grid, end.x(), end.y()), 100);
    int known = 0;
    for (int y = 0; y < grid.height(); ++y) {
      for (int x = 0; x < grid.width(); ++x) {
        known += grid.occupancy(x, y) != OccupancyGrid::kUnknown ? 1 : 0;
      }
    }
    // A straight line enters one cell for each border it crosses, and the first.
    const auto cell = [](double v) { return static_cast<int>(std::floor(v / kCell)); };
    EXPECT_EQ(known, 1 + std::abs(cell(end.x()) - cell(eye.x())) +
                         std::abs(cell(end.y()) - cell(eye.y())));
    for (double t = 0.0; t < 1.0; t += 0.003) {
      const Eigen::Vector2d p = eye + t * (end - eye);
      EXPECT_NE(occupancy_at(grid, p.x(), p.y()), OccupancyGrid::kUnknown);
    }
  }
}

TEST(OccupancyGrid, GrowingKeepsWhatWasDrawn) {
  OccupancyGrid grid(kCell);
  ASSERT_TRUE(grid.add_ray({0.05, 0.05}, {1.05, 0.05}));
  ASSERT_TRUE(grid.add_ray({-40.0, -70.0}, {-41.0, -70.0}));
  ASSERT_TRUE(grid.add_ray({90.0, 30.0}, {90.0, 31.0}));
  EXPECT_EQ(occupancy_at(grid, 1.05, 0.05), 100);
  EXPECT_EQ(occupancy_at(grid, 0.55, 0.05), 0);
  EXPECT_EQ(occupancy_at(grid, 90.0, 31.0), 100);
}

TEST(OccupancyGrid, RefusesWhatNoGridCanHold) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  OccupancyGrid grid(kCell);
  EXPECT_FALSE(grid.add_ray({0, 0}, {kNan, 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {std::numeric_limits<double>::infinity(), 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {1e30, 0}));
  EXPECT_FALSE(grid.add_ray({0, 0}, {1e5, 1e5}));
  EXPECT_EQ(grid.width(), 0);
}

}  // namespace
}  // namespace nodmap::slam2d
