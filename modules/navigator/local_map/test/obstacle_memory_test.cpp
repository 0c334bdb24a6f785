// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/obstacle_memory.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace nodmap::navigator {
namespace obstacle_memory_test {

constexpr double kCellM = 0.025;
constexpr double kTopM = 0.5;

LocalGrid grid_around_origin() {
  LocalGrid grid(kCellM, 9);
  grid.center_on({0.0, 0.0});
  return grid;
}

// A beam along x, from a level laser above the origin.
Beam level_beam(double height_m) {
  return {{0.0, 0.0, height_m}, {1.0, 0.0, 0.0}, std::numeric_limits<double>::infinity(), false};
}

// An obstacle needs one certain hit, or two uncertain ones in two scans: several in one scan count
// once.
TEST(ObstacleMemory, TwoUncertainHitsOrOneCertainMakeAnObstacle) {
  const ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  const Eigen::Vector3d p(1.0, 0.0, 0.04);
  memory.add_hit(grid, p, false, 1);
  memory.add_hit(grid, p, false, 1);
  EXPECT_FALSE(grid.find(p.head<2>())->is_obstacle());
  memory.add_hit(grid, p, false, 2);
  EXPECT_TRUE(grid.find(p.head<2>())->is_obstacle());
  memory.add_hit(grid, {-1.0, 0.0, 0.2}, true, 1);
  EXPECT_TRUE(grid.find({-1.0, 0.0})->is_obstacle());
  // A certain one counts also after an uncertain one of the same scan.
  memory.add_hit(grid, {0.0, 1.0, 0.04}, false, 1);
  memory.add_hit(grid, {0.0, 1.0, 0.2}, true, 1);
  EXPECT_TRUE(grid.find({0.0, 1.0})->is_obstacle());
}

// Each scan whose beams pass through an obstacle takes away one unit of evidence. Beams above what
// was measured do not count.
TEST(ObstacleMemory, ABeamThroughAnObstacleTakesEvidenceAwayOncePerScan) {
  const ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  memory.add_hit(grid, {1.0, 0.0, 0.20}, true, 1);
  const LocalCell& cell = *grid.find({1.0, 0.0});
  ObstacleMemory::pass(grid, level_beam(0.215), 3.0, kTopM, 2);  // above it
  EXPECT_EQ(cell.obstacle, evidence::kCertain);
  ObstacleMemory::pass(grid, level_beam(0.205), 0.9, kTopM, 3);   // ends before it
  ObstacleMemory::pass(grid, level_beam(0.205), 1.02, kTopM, 3);  // ends at it, within the noise
  EXPECT_EQ(cell.obstacle, evidence::kCertain);
  ObstacleMemory::pass(grid, level_beam(0.205), 3.0, kTopM, 4);
  ObstacleMemory::pass(grid, level_beam(0.205), 3.0, kTopM, 4);
  EXPECT_EQ(cell.obstacle, evidence::kCertain - 1);
  ObstacleMemory::pass(grid, level_beam(0.15), 3.0, kTopM, 5);  // below it
  EXPECT_EQ(cell.obstacle, evidence::kCertain - 1);
  memory.add_hit(grid, {1.0, 0.0, 0.10}, true, 6);
  ObstacleMemory::pass(grid, level_beam(0.15), 3.0, kTopM, 7);
  EXPECT_EQ(cell.obstacle, 2 * evidence::kCertain - 2);
}

TEST(ObstacleMemory, BeamsDoNotRemoveAContact) {
  const ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  const robot::Footprint body{0.225, 0.165};
  const Eigen::Vector2d p(0.5 + body.half_length_m + kCellM, 0.0);
  // Nor by the heights that were measured there before: a beam between them passes beside it.
  memory.add_hit(grid, {p.x(), p.y(), 0.1}, true, 0);
  memory.add_hit(grid, {p.x(), p.y(), 0.3}, true, 0);
  memory.add_contact(grid, {0.5, 0.0, 0.0}, body, true);
  const LocalCell& touched = *grid.find(p);
  ASSERT_TRUE(touched.is_obstacle());
  for (std::uint16_t scan = 1; scan < 20; ++scan) {
    ObstacleMemory::pass(grid, level_beam(0.2), 3.0, kTopM, scan);
  }
  EXPECT_TRUE(touched.is_obstacle());
  memory.add_contact(grid, {0.5, 0.0, 0.0}, body, false);
  EXPECT_TRUE(grid.find({0.5 - body.half_length_m - kCellM, 0.0})->is_obstacle()) << "behind";
}

// Travel: each metre counts as 1 m, each radian of rotation as 4 m.
TEST(ObstacleMemory, ForgetsAfterTravel) {
  ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  memory.add_hit(grid, {2.0, 0.0, 0.2}, true, 1);
  const LocalCell& cell = *grid.find({2.0, 0.0});
  memory.move({0.0, 0.0, 0.0}, {11.9, 0.0, 0.0});
  memory.move({11.9, 0.0, 0.0}, {11.9, 0.0, 2.0});
  EXPECT_FALSE(memory.is_forgotten(cell));  // 19.9 m
  memory.move({11.9, 0.0, 2.0}, {12.1, 0.0, 2.0});
  EXPECT_TRUE(memory.is_forgotten(cell));
}

TEST(ObstacleMemory, WhatIsSeenAgainIsRememberedFromThenOn) {
  ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  const robot::Footprint body{0.225, 0.165};
  const LocalCell& hit = *grid.find({2.0, 0.0});
  const LocalCell& touched = *grid.find({body.half_length_m + kCellM, 0.0});
  for (std::uint16_t scan = 1; scan < 4; ++scan) {
    memory.add_hit(grid, {2.0, 0.0, 0.2}, true, scan);
    memory.add_contact(grid, {}, body, true);
    memory.move({}, {15.0, 0.0, 0.0});
    EXPECT_FALSE(memory.is_forgotten(hit));
    EXPECT_FALSE(memory.is_forgotten(touched));
  }
}

// Otherwise a single beam that may be noise would bring it back.
TEST(ObstacleMemory, WhatWasForgottenIsNoEvidence) {
  ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  memory.add_hit(grid, {2.0, 0.0, 0.2}, true, 1);
  memory.move({}, {21.0, 0.0, 0.0});
  memory.add_hit(grid, {2.0, 0.0, 0.04}, false, 2);
  EXPECT_FALSE(grid.find({2.0, 0.0})->is_obstacle());
}

// The stamps of cells begin anew after 6553.6 m.
TEST(ObstacleMemory, ForgetsAfterTheSameTravelHoweverFarTheRobotHasCome) {
  ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  memory.move({}, {6550.0, 0.0, 0.0});
  memory.add_hit(grid, {2.0, 0.0, 0.2}, true, 1);
  const LocalCell& cell = *grid.find({2.0, 0.0});
  memory.move({}, {19.0, 0.0, 0.0});
  EXPECT_FALSE(memory.is_forgotten(cell));
  memory.move({}, {2.0, 0.0, 0.0});
  EXPECT_TRUE(memory.is_forgotten(cell));
}

// Neither far from the robot nor near it.
TEST(ObstacleMemory, WhatIsForgottenNeverComesBack) {
  ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  memory.add_hit(grid, {2.0, 0.0, 0.2}, true, 1);
  memory.add_hit(grid, {0.4, 0.0, 0.2}, true, 1);
  double travel_m = 0.0;
  for (; travel_m < 15e3; travel_m += 10.0) {
    memory.move({0.0, 0.0, 0.0}, {10.0, 0.0, 0.0});
    memory.keep_near(grid, {0.0, 0.0});
    const bool is_back = travel_m > 200.0 && (!memory.is_forgotten(*grid.find({2.0, 0.0})) ||
                                              !memory.is_forgotten(*grid.find({0.4, 0.0})));
    ASSERT_FALSE(is_back) << travel_m;
  }
  EXPECT_TRUE(grid.find({2.0, 0.0})->is_obstacle()) << "beams have not passed";
}

TEST(ObstacleMemory, AnObstacleNearTheRobotIsNeverOlderThanItsLastHit) {
  ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  memory.move({}, {1.0, 0.0, 0.0});
  memory.add_hit(grid, {0.4, 0.0, 0.2}, true, 1);
  memory.keep_near(grid, {0.0, 0.0});
  EXPECT_FALSE(memory.is_forgotten(*grid.find({0.4, 0.0})));
}

// Near the robot, travel counts a fifth, except for the last metre: 95 m count as 18.8 m and 1 m.
TEST(ObstacleMemory, AnObstacleNearTheRobotAgesFiveTimesMoreSlowly) {
  ObstacleMemory memory(20.0);
  LocalGrid grid = grid_around_origin();
  memory.add_hit(grid, {0.4, 0.0, 0.2}, true, 1);
  memory.add_hit(grid, {0.6, 0.0, 0.2}, true, 1);
  const auto travel = [&](int metres) {
    for (int i = 0; i < metres; ++i) {
      memory.move({0.0, 0.0, 0.0}, {0.5, 0.0, 0.0});
      memory.move({0.5, 0.0, 0.0}, {0.0, 0.0, 0.0});
      memory.keep_near(grid, {0.0, 0.0});
    }
  };
  travel(94);
  EXPECT_FALSE(memory.is_forgotten(*grid.find({0.4, 0.0})));
  EXPECT_TRUE(memory.is_forgotten(*grid.find({0.6, 0.0})));
  travel(6);
  EXPECT_TRUE(memory.is_forgotten(*grid.find({0.4, 0.0})));
}

}  // namespace obstacle_memory_test
}  // namespace nodmap::navigator
