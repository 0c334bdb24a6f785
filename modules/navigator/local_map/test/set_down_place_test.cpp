// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/set_down_place.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::navigator {
namespace set_down_place_test {

// With cells of 2.5 cm, a cell whose middle is within the circle is floor, and one that does not
// touch it is not.
TEST(SetDownPlace, FloorIsAssumedWithinTheCircle) {
  constexpr double kCellM = 0.025;
  constexpr double kBlindM = 0.44;
  LocalGrid grid(kCellM, 7);
  const Eigen::Vector2d place(0.3, -0.2);
  grid.center_on(place);
  SetDownPlace set_down(kBlindM);
  set_down.begin(grid, place);
  int num_floor = 0;
  for (double x = -1.0; x < 1.0; x += kCellM) {
    for (double y = -1.0; y < 1.0; y += kCellM) {
      const Eigen::Vector2i index = grid.index_of(place + Eigen::Vector2d(x, y));
      const double range_m = (grid.center_of(index) - place).norm();
      const LocalCell& cell = grid.at(index);
      EXPECT_EQ(cell.is_floor, cell.is_assumed);
      EXPECT_TRUE(cell.is_floor || range_m > kBlindM - kCellM) << x << " " << y;
      EXPECT_FALSE(cell.is_floor && range_m > kBlindM + kCellM) << x << " " << y;
      num_floor += cell.is_floor ? 1 : 0;
    }
  }
  EXPECT_GT(num_floor, 0);
}

// The grid reaches 0.4 m to each side.
TEST(SetDownPlace, ALaserThatIsBlindBeyondTheGridLeavesNoCellWithoutFloor) {
  LocalGrid grid(0.1, 3);
  SetDownPlace set_down(5.0);
  set_down.begin(grid, {0.0, 0.0});
  EXPECT_TRUE(grid.at(grid.first()).is_assumed);
  EXPECT_TRUE(set_down.never_seen_around(grid, {0.0, 0.0}).empty());
}

// A grid of floor, but for a strip of this width along x.
LocalGrid floor_beside_strip(double width_m) {
  LocalGrid grid(0.025, 8);
  grid.center_on({0.0, 0.0});
  for (double x = -3.0; x < 3.0; x += 0.0125) {
    for (double y = -3.0; y < 3.0; y += 0.0125) {
      grid.find({x, y})->is_floor = std::abs(y) > 0.5 * width_m;
    }
  }
  return grid;
}

// The laser sees no floor within 0.44 m of base.
TEST(SetDownPlace, GroundThatWasNotSeenCountsWithinAMetreAndWhereTheLaserDoesNotLook) {
  LocalGrid grid = floor_beside_strip(0.3);
  SetDownPlace set_down(0.44);
  set_down.begin(grid, {0.0, 0.0});
  const auto points = set_down.never_seen_around(grid, {0.8, 0.0});
  ASSERT_FALSE(points.empty());
  for (const Eigen::Vector2d& p : points) {
    EXPECT_LE(std::abs(p.y()), 0.15);
    EXPECT_GE(p.norm(), 0.44) << "floor is assumed";
    EXPECT_LE(p.norm(), 1.0);
    EXPECT_LE((p - Eigen::Vector2d(0.8, 0.0)).norm(), 0.44 + 0.025);
  }
  EXPECT_TRUE(set_down.never_seen_around(grid, {1.5, 0.0}).empty());
  EXPECT_TRUE(set_down.never_seen_around(floor_beside_strip(0.0), {0.8, 0.0}).empty());
}

// 14 cm lie between the body's front and the nearest floor that the laser sees.
TEST(SetDownPlace, OfLessThan15CentimetresNothingCounts) {
  for (const double width_m : {0.14, 0.2}) {
    LocalGrid grid = floor_beside_strip(width_m);
    SetDownPlace set_down(0.44);
    set_down.begin(grid, {0.0, 0.0});
    EXPECT_EQ(set_down.never_seen_around(grid, {0.7, 0.0}).empty(), width_m < 0.15) << width_m;
  }
}

}  // namespace set_down_place_test
}  // namespace nodmap::navigator
