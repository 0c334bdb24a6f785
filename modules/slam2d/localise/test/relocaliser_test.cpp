// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/localise/relocaliser.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace relocaliser_test {

using geometry::SE2;
using Status = Relocalisation::Status;

class RelocaliserTest : public testing::Test {
 protected:
  Relocalisation locate(const KnownMap& map, const test::FloorPlan& plan, const SE2& truth) {
    return Relocaliser({}, {}).locate(
        map,
        {.T_odom_base = truth, .points_base = extractor_.extract(scanner_.scan(plan, truth), {})});
  }

  test::Scanner scanner_;
  OrientedPointExtractor extractor_;
};

TEST_F(RelocaliserTest, FindsTheRobotAnywhereInARoom) {
  const KnownMap map(trinary(test::drawn_grid(test::room(), test::poses_in_room())), {});
  std::mt19937 random(4);
  std::uniform_real_distribution<double> x(-2.5, 1.7);
  std::uniform_real_distribution<double> y(-1.5, 2.5);
  std::uniform_real_distribution<double> yaw(-3.14, 3.14);
  int found = 0;
  for (int run = 0; run < 30; ++run) {
    const SE2 truth{x(random), y(random), yaw(random)};
    const Relocalisation result = locate(map, test::room(), truth);
    if (result.status != Status::kFound) {
      continue;
    }
    ++found;
    // The tolerance is a cell of 5 cm; a scan sees only one or two corners.
    EXPECT_NEAR(result.T_map_base.x, truth.x, 0.05);
    EXPECT_NEAR(result.T_map_base.y, truth.y, 0.05);
    EXPECT_NEAR(geometry::angle_difference(result.T_map_base.yaw, truth.yaw), 0.0, 0.03);
  }
  EXPECT_GE(found, 18);  // measured: 22; a robot that faces a bare wall cannot be found
}

// All walls are on one side of the yard, metres away from where the robot is.
TEST_F(RelocaliserTest, ARobotInFrontOfAFacadeIsFound) {
  const test::FloorPlan facade{{{-6, 0}, {-2, 0}},  {{-2, 0}, {-2, 1.5}}, {{-2, 1.5}, {1, 1.5}},
                               {{1, 1.5}, {1, 0}},  {{1, 0}, {6, 0}},     {{6, 0}, {6, 3}},
                               {{-6, 0}, {-6, 1.5}}};
  std::vector<SE2> poses;
  for (double x = -5.0; x <= 5.0; x += 0.5) {
    poses.push_back({x, -5.0, 0.5 * geometry::kPi});
  }
  const KnownMap map(trinary(test::drawn_grid(facade, poses)), {});
  for (const SE2& truth : {SE2{0.0, -4.0, 1.5}, SE2{2.0, -3.0, 1.9}}) {
    const Relocalisation result = locate(map, facade, truth);
    EXPECT_EQ(result.status, Status::kFound);
    EXPECT_LT(geometry::distance_m(result.T_map_base, truth), 0.05);  // a cell
  }
}

// The hall looks the same when rotated by 180 degrees.
TEST_F(RelocaliserTest, ThePlaceInASymmetricHallIsAmbiguous) {
  const test::FloorPlan hall{
      {{-6, -4}, {6, -4}}, {{6, -4}, {6, 4}}, {{6, 4}, {-6, 4}}, {{-6, 4}, {-6, -4}}};
  std::vector<SE2> poses;
  for (double yaw = 0.0; yaw < 6.2; yaw += 0.2) {
    poses.push_back({0.0, 0.0, yaw});
  }
  const KnownMap map(trinary(test::drawn_grid(hall, poses)), {});
  for (const SE2& truth : {SE2{1.0, 0.5, 0.2}, SE2{-3.0, 2.0, 2.0}, SE2{4.0, -1.0, -2.5}}) {
    EXPECT_EQ(locate(map, hall, truth).status, Status::kAmbiguous);
  }
}

// A corridor with baffles that looks the same when rotated by 180 degrees. Noise in the map makes a
// match score up to a few hundredths more at one of the two places.
TEST_F(RelocaliserTest, NoiseInTheMapDoesNotTellPlacesApartThatLookAlike) {
  const test::FloorPlan zigzag{{{-3, -1.2}, {3, -1.2}},     {{3, -1.2}, {3, 1.2}},
                               {{3, 1.2}, {-3, 1.2}},       {{-3, 1.2}, {-3, -1.2}},
                               {{-1.5, -1.2}, {-1.5, 0.4}}, {{0, 1.2}, {0, 0.5}},
                               {{0, -1.2}, {0, -0.5}},      {{1.5, 1.2}, {1.5, -0.4}}};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(-2.7, 2.7);
  std::uniform_real_distribution<double> y(-0.9, 0.9);
  std::uniform_real_distribution<double> yaw(-geometry::kPi, geometry::kPi);
  std::vector<SE2> poses;
  for (int i = 0; i < 120; ++i) {
    poses.push_back({x(random), y(random), yaw(random)});
  }
  const KnownMap map(trinary(test::drawn_grid(zigzag, poses)), {});
  for (int i = 0; i < 60; ++i) {
    const SE2 truth{x(random), y(random), yaw(random)};
    EXPECT_NE(locate(map, zigzag, truth).status, Status::kFound);
  }
}

TEST_F(RelocaliserTest, FindsNothingInAnotherBuildingOrWithoutPoints) {
  const KnownMap map(trinary(test::drawn_grid(test::room(), test::poses_in_room())), {});
  for (const double x : {3.0, 8.0, 14.0}) {
    EXPECT_NE(locate(map, test::ring_corridor(), {x, 0.2, 0.3}).status, Status::kFound);
  }
  EXPECT_EQ(Relocaliser({}, {}).locate(map, LevelScan{}).status, Status::kNowhere);
  const KnownMap empty(TrinaryGrid{}, {});
  EXPECT_EQ(locate(empty, test::room(), {}).status, Status::kNowhere);
}

TEST(KnownMap, PointsBehindAWallWereMeasuredThroughIt) {
  TrinaryGrid grid{.cell_size_m = 0.1, .width = 50, .height = 20};
  grid.cells.assign(1000, CellState::kFree);
  for (std::size_t y = 0; y < 20; ++y) {
    grid.cells[y * 50 + 20] = CellState::kOccupied;  // a wall at x = 2.0 to 2.1 m
  }
  const KnownMap map(grid, {});
  const std::vector<OrientedPoint> scan{
      {{1.0, 0.0}, {}}, {{0.5, 0.0}, {}}, {{3.0, 0.0}, {}}, {{1.05, 0.1}, {}}};
  // The third.
  EXPECT_DOUBLE_EQ(map.fit_walls(scan, {0.0, 0.0}, {1.02, 1.0, 0.0}).through_walls, 0.25);
}

TEST(KnownMap, PointsWithinACellOfAnOccupiedCellAreOnTheWall) {
  TrinaryGrid grid{.cell_size_m = 0.05, .width = 100, .height = 40};
  grid.cells.assign(4000, CellState::kFree);
  for (std::size_t y = 0; y < 40; ++y) {
    grid.cells[y * 100 + 40] = CellState::kOccupied;  // from x = 2.0 to 2.05 m
  }
  const KnownMap map(grid, {});
  const std::vector<OrientedPoint> scan{
      {{2.02, 0.0}, {}}, {{2.09, 0.0}, {}}, {{2.11, 0.0}, {}}, {{1.94, 0.0}, {}}};
  const WallFit walls = map.fit_walls(scan, {0.0, 0.0}, {0.0, 1.0, 0.0});
  EXPECT_DOUBLE_EQ(walls.on_walls, 0.5);  // the first two
  EXPECT_DOUBLE_EQ(walls.score(), walls.on_walls - walls.through_walls);
  EXPECT_EQ(map.fit_walls({}, {0.0, 0.0}, {}).on_walls, 0.0);
}

// One free cell is beside an occupied one, and another is as far away as free cells count, 10 cm,
// or one cell farther. Divided by most sizes of a cell, that distance is no whole number in binary.
TEST(KnownMap, ANormalTakesInTheFreeCellsWithinTenCentimetres) {
  for (const auto& [cell_size_m, reach] : {std::pair{0.1, 1}, {0.05, 2}, {0.02, 5}, {0.01, 10}}) {
    for (const int beyond : {0, 1}) {
      TrinaryGrid grid{.cell_size_m = cell_size_m, .width = 30, .height = 30};
      grid.cells.assign(900, CellState::kUnknown);
      const auto at = [&](int x, int y) -> CellState& {
        return grid.cells[static_cast<std::size_t>(30 * y + x)];
      };
      at(15, 15) = CellState::kOccupied;
      at(16, 15) = CellState::kFree;
      at(15, 15 + reach + beyond) = CellState::kFree;
      const KnownMap map(grid, {});
      ASSERT_EQ(map.points().points().size(), 1U);
      const Eigen::Vector2d expected =
          beyond == 0 ? Eigen::Vector2d(1.0, 1.0).normalized() : Eigen::Vector2d(1.0, 0.0);
      EXPECT_TRUE(map.points().points().front().point.normal.isApprox(expected)) << cell_size_m;
    }
  }
}

// The rays that the map looks along in long steps are compared with rays looked along cell by cell.
TEST(KnownMap, ARayIsBlockedByOccupiedCellsOnItsWayAndOnBothSides) {
  constexpr int kSize = 60;
  constexpr double kCellM = 0.1;
  std::mt19937 random(1);
  TrinaryGrid grid{.cell_size_m = kCellM, .width = kSize, .height = kSize};
  for (int i = 0; i < kSize * kSize; ++i) {
    grid.cells.push_back(random() % 40 == 0 ? CellState::kOccupied : CellState::kFree);
  }
  const KnownMap map(grid, {});
  std::uniform_real_distribution<double> inside_m(0.5, 5.5);
  std::uniform_real_distribution<double> outside_m(-2.0, 8.0);
  int blocked = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d from(inside_m(random), inside_m(random));
    const Eigen::Vector2d to(outside_m(random), outside_m(random));
    const double range_m = (to - from).norm();
    const Eigen::Vector2d direction = (to - from) / range_m;
    bool is_blocked = true;
    for (const double aside_m : {-0.06, 0.0, 0.06}) {
      const Eigen::Vector2d start = from + aside_m * direction.unitOrthogonal();
      bool meets_occupied = false;
      for (int step = 0; step * kCellM < range_m - 0.4; ++step) {
        const Eigen::Vector2d cell = start / kCellM + step * direction;
        meets_occupied = meets_occupied ||
                         grid.at(static_cast<int>(std::floor(cell.x())),
                                 static_cast<int>(std::floor(cell.y()))) == CellState::kOccupied;
      }
      is_blocked = is_blocked && meets_occupied;
    }
    blocked += is_blocked ? 1 : 0;
    OrientedPoint point;
    point.p = to - from;
    EXPECT_EQ(map.fit_walls({&point, 1}, {0.0, 0.0}, {from.x(), from.y(), 0.0}).through_walls,
              is_blocked ? 1.0 : 0.0);
  }
  EXPECT_GT(blocked, 100);
  EXPECT_LT(blocked, 900);
}

}  // namespace relocaliser_test
}  // namespace nodmap::slam2d
