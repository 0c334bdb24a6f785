// SPDX-License-Identifier: BSD-3-Clause
// The obstacle map in complete scenes, by both update rules.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "modules/map_server/test/scene.hpp"

namespace nodmap::map_server {
namespace obstacle_map_test {

using test::Box;
using test::deg_to_rad;
using test::drive;
using test::has_point_near;
using test::NoddingScanner;
using test::SE2;
using test::stay;
using test::with_rule;
using test::World;

TEST(Scene, OneScanReplacesAllDummiesAhead) {
  MapServerParams params;
  params.bins.aperture_rad = deg_to_rad(180);
  MapServer server(params);
  NoddingScanner scanner;
  scanner.step_rad = 0.0;
  ASSERT_EQ(server.obstacle_map().scan().size(), 181U);
  EXPECT_FALSE(server.obstacle_map().scan()[90].valid);
  stay(server, scanner, test::room(-3, 5, -2, 2), 1);
  for (std::size_t i = 0; i < 181; ++i) {
    EXPECT_TRUE(server.obstacle_map().scan()[i].valid) << "bin " << i;
    EXPECT_TRUE(server.structure_map().scan()[i].valid) << "bin " << i;
  }
}

// There are no walls, so every obstacle would be floor.
TEST(Scene, FlatFloorIsNotAnObstacle) {
  MapServer server({});
  NoddingScanner scanner;
  scanner.range_sigma_m = 0.01;
  scanner.pitch_sigma_rad = deg_to_rad(0.1);
  std::size_t floor_points = 0;
  for (int i = 0; i * NoddingScanner::kPeriodS < 60.0; ++i) {
    stay(server, scanner, World{}, 1);
    floor_points += static_cast<std::size_t>(std::ranges::count_if(
        server.obstacle_map().scan().points(), [](const EgoPoint& p) { return p.valid; }));
  }
  // The limit is 5 cm plus 3 sigma: within 32 m that takes an error of 3.9 sigma, which none of
  // 4500 scans is expected to have.
  EXPECT_EQ(floor_points, 0U);
}

// A person steps in front of a stationary robot and leaves again.
TEST(Scene, APersonWhoLeftIsRemovedWhileTheRobotIsStationary) {
  const World empty = test::room(-2, 5, -3, 3);
  World occupied = empty;
  occupied.cylinders.push_back({{1.8, 0.0}, 0.25, 1.75});
  const auto ghost_after = [&](RemovalRule rule, int sweeps) {
    MapServer server(with_rule(rule));
    NoddingScanner scanner;
    scanner.range_sigma_m = 0.01;
    stay(server, scanner, empty, 100);
    stay(server, scanner, occupied, 100);
    EXPECT_TRUE(has_point_near(server.obstacle_map(), {1.55, 0.0}, 0.1));
    stay(server, scanner, empty, sweeps * scanner.scans_per_sweep());
    return has_point_near(server.obstacle_map(), {1.6, 0.0}, 0.4);
  };
  EXPECT_TRUE(ghost_after(RemovalRule::kPaper, 100))
      << "by the paper nothing ages while stationary";
  EXPECT_FALSE(ghost_after(RemovalRule::kVisibility, 2));
}

// Whether the map contains the front of the box at every update from its first measurement until
// the robot's bumper reaches it.
bool holds_until_passed(RemovalRule rule, const Box& box, double speed_mps) {
  World world = test::room(-2, 8, -2, 2);
  world.boxes.push_back(box);
  MapServer server(with_rule(rule));
  NoddingScanner scanner;
  scanner.range_sigma_m = 0.01;
  bool seen = false;
  bool lost = false;
  const double distance_m = box.low.x() - 0.225;
  drive(server, scanner, world, speed_mps, distance_m / speed_mps, [&](const SE2& pose) {
    const Eigen::Vector2d front(box.low.x() - pose.x, 0.0);
    // Ten centimetres: the width of the gaps between neighbouring points at this distance.
    const bool held = has_point_near(server.obstacle_map(), front, 0.10);
    seen = seen || held;
    lost = lost || (seen && front.x() < 1.5 && !held);
  });
  return seen && !lost;
}

// Nearer than d_min a low box is below the sweeps and only remembered. By the paper's rule it is
// lost at any speed below d_min / 5 s.
TEST(Scene, ALowBoxIsRememberedBelowTheSweeps) {
  const Box low_box{{2.0, -0.2, 0.0}, {2.4, 0.2, 0.10}};
  EXPECT_FALSE(holds_until_passed(RemovalRule::kPaper, low_box, 0.1))
      << "by the paper it expires, and the robot drives into it";
  EXPECT_TRUE(holds_until_passed(RemovalRule::kVisibility, low_box, 0.1));
}

TEST(Scene, ALowBoxIsRememberedAtEverySpeedAndHeight) {
  for (const double speed_mps : {0.03, 0.2, 0.5}) {
    for (const double top_m : {0.08, 0.12, 0.20, 0.30}) {
      const Box box{{2.0, -0.2, 0.0}, {2.4, 0.2, top_m}};
      EXPECT_TRUE(holds_until_passed(RemovalRule::kVisibility, box, speed_mps))
          << speed_mps << " m/s, " << top_m << " m high";
    }
  }
}

TEST(Scene, ATableTopIsRememberedAboveTheSweeps) {
  const Box table_top{{2.0, -0.4, 0.42}, {2.8, 0.4, 0.46}};
  for (const double speed_mps : {0.03, 0.1, 0.5}) {
    EXPECT_TRUE(holds_until_passed(RemovalRule::kVisibility, table_top, speed_mps)) << speed_mps;
  }
}

// A minute's drive through a corridor in which nothing moves.
struct CorridorDrive {
  std::size_t obstacles_removed = 0;
  std::size_t structure_removed = 0;
  // Number of dummies within 85 degrees of ahead in the obstacle map, over all updates.
  int dummies = 0;
};

CorridorDrive drive_a_minute(const MapServerParams& params) {
  const World world = test::room(-2, 25, -1.5, 1.5);
  MapServer server(params);
  NoddingScanner scanner;
  scanner.range_sigma_m = 0.01;
  const ExtendedScan& map = server.obstacle_map().scan();
  CorridorDrive result;
  drive(server, scanner, world, 0.3, 60.0, [&](const SE2&) {
    for (int deg = -85; deg <= 85; ++deg) {
      result.dummies += map[*map.bins().index(deg_to_rad(deg))].valid ? 0 : 1;
    }
  });
  result.obstacles_removed = server.obstacle_map().removed();
  result.structure_removed = server.structure_map().removed();
  return result;
}

MapServerParams without_removal(RemovalRule rule) {
  MapServerParams params = with_rule(rule);
  params.update.expiry_s = 600.0;
  params.update.misses_to_remove = 100;
  return params;
}

// Driving alone leaves bins empty until the next sweep, because their points move to other bins.
// The visibility rule adds no empty bins. By the paper's rule a wall expires if it is measured
// again only slightly farther away: 1386 more dummies, of which at least 4/5 are required.
TEST(Scene, AStaticWallIsNeverRemoved) {
  const CorridorDrive visibility = drive_a_minute({});
  EXPECT_EQ(visibility.obstacles_removed, 0U);
  // The far corner of the corridor is behind the line between the beams beside it, so it counts as
  // occluded.
  EXPECT_LE(visibility.structure_removed, 1U);
  EXPECT_EQ(visibility.dummies, drive_a_minute(without_removal(RemovalRule::kVisibility)).dummies);
  const CorridorDrive paper = drive_a_minute(with_rule(RemovalRule::kPaper));
  EXPECT_GT(paper.obstacles_removed, 438U);  // 4/5 of 548
  EXPECT_GT(paper.dummies, drive_a_minute(without_removal(RemovalRule::kPaper)).dummies + 1108);
}

// A sweep of 120 degrees at 0.25 degrees per scan takes 6.4 s, longer than expiry_s. Nothing may be
// removed between two sweeps over it.
TEST(Scene, AStaticWallStaysWithASlowNod) {
  const World world = test::room(-2, 6, -2, 2);
  MapServer server(with_rule(RemovalRule::kVisibility));
  NoddingScanner scanner;
  scanner.low_rad = deg_to_rad(-60);
  scanner.high_rad = deg_to_rad(60);
  scanner.step_rad = deg_to_rad(0.25);
  for (int i = 0; i < 5 * 480; ++i) {
    server.add_scan(scanner.scan(world, SE2{}), geometry::SE3::Identity());
  }
  EXPECT_EQ(server.obstacle_map().removed(), 0U);
  EXPECT_EQ(server.structure_map().removed(), 0U);
}

// By the visibility rule an object that is taken away is removed within two sweeps, not after five
// seconds.
TEST(Scene, ARemovedObjectDisappearsWithinTwoSweepsWhileDriving) {
  const World empty = test::room(-2, 8, -2, 2);
  World occupied = empty;
  occupied.boxes.push_back({{3.5, -0.3, 0.0}, {3.8, 0.3, 0.4}});
  MapServer server({});
  NoddingScanner scanner;
  scanner.range_sigma_m = 0.01;
  for (int i = 0; i < 200; ++i) {
    const SE2 pose{0.3 * NoddingScanner::kPeriodS * i, 0, 0};
    const bool vanished = i >= 140;
    server.add_scan(scanner.scan(vanished ? empty : occupied, pose), geometry::to_se3(pose));
    const Eigen::Vector2d front(3.5 - pose.x, 0.0);
    if (i == 139) {
      EXPECT_TRUE(has_point_near(server.obstacle_map(), front, 0.1));
    }
    if (i >= 140 + 2 * scanner.scans_per_sweep()) {
      ASSERT_FALSE(has_point_near(server.obstacle_map(), front, 0.4)) << "scan " << i;
    }
  }
}

// A scanner that does not nod, as in a 2D recording: every scan is a sweep.
TEST(Scene, ALevelScannerRemovesAnObjectWithinTwoScans) {
  const World empty = test::room(-2, 5, -3, 3);
  World occupied = empty;
  occupied.cylinders.push_back({{1.8, 0.0}, 0.25, 1.75});
  MapServer server({});
  NoddingScanner scanner;
  scanner.step_rad = 0.0;
  stay(server, scanner, occupied, 50);
  EXPECT_TRUE(has_point_near(server.obstacle_map(), {1.55, 0.0}, 0.1));
  stay(server, scanner, empty, 2);
  EXPECT_FALSE(has_point_near(server.obstacle_map(), {1.6, 0.0}, 0.4));
}

}  // namespace obstacle_map_test
}  // namespace nodmap::map_server
