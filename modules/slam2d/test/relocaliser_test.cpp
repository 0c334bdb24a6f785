// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/relocaliser.hpp"

#include <gtest/gtest.h>

#include <random>

#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace relocaliser_test {

using geometry::SE2;
using Status = Relocalisation::Status;

class RelocaliserTest : public testing::Test {
 protected:
  Relocalisation locate(const KnownMap& map, const test::FloorPlan& plan, const SE2& truth) {
    const scan::Scan scan = scanner_.scan(plan, truth);
    return Relocaliser({}, {}).locate(map, extractor_.extract(scan, {}), {0.0, 0.0});
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
    // Cells of 5 cm, seen over one corner or two.
    EXPECT_NEAR(result.T_map_base.x, truth.x, 0.05);
    EXPECT_NEAR(result.T_map_base.y, truth.y, 0.05);
    EXPECT_NEAR(geometry::angle_difference(result.T_map_base.yaw, truth.yaw), 0.0, 0.03);
  }
  EXPECT_GE(found, 18);  // measured: 22; facing a bare wall, a place cannot be told
}

// Turned by half a turn, it looks the same from the other side.
TEST_F(RelocaliserTest, InASymmetricHallItSaysThatItDoesNotKnow) {
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

TEST_F(RelocaliserTest, SaysSoInAnotherBuildingAndWithoutPoints) {
  const KnownMap map(trinary(test::drawn_grid(test::room(), test::poses_in_room())), {});
  for (const double x : {3.0, 8.0, 14.0}) {
    EXPECT_NE(locate(map, test::ring_corridor(), {x, 0.2, 0.3}).status, Status::kFound);
  }
  EXPECT_EQ(Relocaliser({}, {}).locate(map, {}, {0.0, 0.0}).status, Status::kNowhere);
  const KnownMap empty(TrinaryGrid{}, {});
  EXPECT_EQ(locate(empty, test::room(), {}).status, Status::kNowhere);
}

TEST(RecentScans, ArePlacedByOdometryAtTheLast) {
  const std::vector<OrientedPoint> points{{{2.0, 0.0}, {-1.0, 0.0}}};
  RecentScans scans(2);
  for (const double x : {0.0, 1.0, 1.5}) {
    scans.add({.T_odom_base = {x, 0.0, 0.0}, .points_base = points});
  }
  ASSERT_EQ(scans.size(), 2U);
  const std::vector<OrientedPoint> seen = scans.points_base();
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_NEAR(seen[0].p.x(), 1.5, 1e-12);  // half a metre nearer by now
  EXPECT_NEAR(seen[1].p.x(), 2.0, 1e-12);
}

TEST(KnownMap, TellsPointsOnWallsFromThoseBehindThem) {
  TrinaryGrid grid{.cell_size_m = 0.1, .width = 50, .height = 20};
  grid.cells.assign(1000, CellState::kFree);
  for (std::size_t y = 0; y < 20; ++y) {
    grid.cells[y * 50 + 20] = CellState::kOccupied;  // a wall at x = 2.0 to 2.1 m
  }
  const KnownMap map(grid, {});
  const std::vector<OrientedPoint> scan{
      {{1.0, 0.0}, {}}, {{0.5, 0.0}, {}}, {{3.0, 0.0}, {}}, {{1.05, 0.1}, {}}};
  const GridFit fit = map.fit(scan, {0.0, 0.0}, {1.02, 1.0, 0.0});
  EXPECT_DOUBLE_EQ(fit.on_walls, 0.5);        // the first and the last
  EXPECT_DOUBLE_EQ(fit.through_walls, 0.25);  // the third
}

}  // namespace relocaliser_test
}  // namespace nodmap::slam2d
