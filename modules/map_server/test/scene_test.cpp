// SPDX-License-Identifier: BSD-3-Clause
// Both update rules in whole scenes: a nodding scanner in a ray-cast world.
#include <gtest/gtest.h>

#include <functional>

#include "modules/map_server/map_server.hpp"
#include "modules/map_server/test/world.hpp"

namespace nodmap::map_server {
namespace {

using test::Box;
using test::deg_to_rad;
using test::NoddingScanner;
using test::SE2;
using test::World;

MapServerParams with_rule(Rule rule) {
  MapServerParams params;
  params.update_rule = rule;
  return params;
}

bool has_point_near(const EgoMap& map, const Eigen::Vector2d& p_base, double radius_m) {
  return std::ranges::any_of(map.scan().points(), [&](const EgoPoint& p) {
    return p.valid && (p.p_base - p_base).norm() < radius_m;
  });
}

void stand(MapServer& server, NoddingScanner& scanner, const World& world, int scans) {
  for (int i = 0; i < scans; ++i) {
    ASSERT_EQ(server.add_scan(scanner.scan(world, {}), geometry::SE3::Identity()), Verdict::kUsed);
  }
}

// Drives ahead at a speed, with exact odometry, and calls back after each scan.
void drive(MapServer& server, NoddingScanner& scanner, const World& world, double speed_mps,
           double duration_s, const std::function<void(const SE2&)>& after_each) {
  for (int i = 0; i * NoddingScanner::kPeriodS < duration_s; ++i) {
    const double t = i * NoddingScanner::kPeriodS;
    const SE2 pose{speed_mps * t, 0.0, 0.0};
    server.add_scan(scanner.scan(world, pose), geometry::to_se3(pose));
    after_each(pose);
  }
}

/// Distance of a place to the nearest of the four walls of test::room, inside it.
double off_walls_m(const Eigen::Vector2d& p, double x0, double x1, double y0, double y1) {
  return std::min(
      {std::abs(p.x() - x0), std::abs(p.x() - x1), std::abs(p.y() - y0), std::abs(p.y() - y1)});
}

TEST(Scene, R21_OneScanReplacesAllDummiesAhead) {
  MapServerParams params;
  params.aperture_rad = deg_to_rad(180);
  MapServer server(params);
  NoddingScanner scanner;
  scanner.step_rad = 0.0;
  ASSERT_EQ(server.obstacle_map().scan().size(), 181U);
  EXPECT_FALSE(server.obstacle_map().scan()[90].valid);
  stand(server, scanner, test::room(-3, 5, -2, 2), 1);
  for (std::size_t i = 0; i < 181; ++i) {
    EXPECT_TRUE(server.obstacle_map().scan()[i].valid) << "bin " << i;
    EXPECT_TRUE(server.structure_map().scan()[i].valid) << "bin " << i;
  }
}

// R14: the walls are far, so every obstacle would be floor.
TEST(Scene, R14_FlatFloorIsNoObstacle) {
  MapServer server({});
  NoddingScanner scanner;
  scanner.range_sigma_m = 0.01;
  scanner.pitch_sigma_rad = deg_to_rad(0.1);
  std::size_t floor_points = 0;
  for (int i = 0; i * NoddingScanner::kPeriodS < 60.0; ++i) {
    stand(server, scanner, World{}, 1);
    floor_points += static_cast<std::size_t>(std::ranges::count_if(
        server.obstacle_map().scan().points(), [](const EgoPoint& p) { return p.valid; }));
  }
  // A line at 3 sigma is one in 700, and its points last two sweeps: a few bins, far away.
  EXPECT_EQ(floor_points, 0U);
}

World furnished_room() {
  World world = test::room(-2, 5, -3, 3);
  world.cylinders.push_back({{3.2, -1.5}, 0.25, 1.7});          // a person
  world.boxes.push_back({{2.0, 0.5, 0.70}, {3.0, 1.7, 0.74}});  // a table top,
  for (const double x : {2.0, 2.95}) {                          // its legs,
    for (const double y : {0.5, 1.65}) {
      world.boxes.push_back({{x, y, 0.0}, {x + 0.05, y + 0.05, 0.7}});
    }
  }
  world.boxes.push_back({{2.2, -0.6, 0.0}, {2.6, -0.2, 0.45}});  // and the seat of a chair
  return world;
}

// R15, the paper's Fig. 4: what does not extend over all the height vanishes from the structure map
// and stays in the obstacle map.
TEST(Scene, R15_FurnitureVanishesFromTheStructureMap) {
  for (const Rule rule : {Rule::kPaper, Rule::kConfirmed}) {
    MapServer server(with_rule(rule));
    NoddingScanner scanner;
    scanner.low_rad = deg_to_rad(-30);
    scanner.high_rad = deg_to_rad(28);  // over the person, under the top of the wall
    scanner.range_sigma_m = 0.01;
    stand(server, scanner, furnished_room(), 2 * scanner.scans_per_sweep());
    int valid = 0;
    int on_wall = 0;
    for (const EgoPoint& p : server.structure_map().scan().points()) {
      valid += p.valid ? 1 : 0;
      on_wall += p.valid && off_walls_m(p.p_base, -2, 5, -3, 3) < 0.05 ? 1 : 0;
    }
    EXPECT_GE(valid, 175);
    EXPECT_GE(on_wall, 0.95 * valid);
    const EgoMap& obstacles = server.obstacle_map();
    EXPECT_TRUE(has_point_near(obstacles, {2.95, -1.5}, 0.06)) << "person";
    EXPECT_TRUE(has_point_near(obstacles, {2.2, -0.4}, 0.06)) << "chair";
    EXPECT_TRUE(has_point_near(obstacles, {2.0, 0.525}, 0.06)) << "leg of the table";
  }
}

// R16: a person crosses ten times, two metres before the wall.
TEST(Scene, R16_WalkingPersonDoesNotHideTheWall) {
  MapServer server({});
  NoddingScanner scanner;
  scanner.low_rad = deg_to_rad(-25);
  scanner.high_rad = deg_to_rad(28);
  scanner.range_sigma_m = 0.01;
  const World empty = test::room(-2, 5, -3, 3);
  stand(server, scanner, empty, 2 * scanner.scans_per_sweep());
  long bins = 0;
  long on_wall = 0;
  long raw_on_wall = 0;
  for (int i = 0; i * NoddingScanner::kPeriodS < 40.0; ++i) {
    const double t = i * NoddingScanner::kPeriodS;
    World world = empty;
    const double way = std::fmod(t, 8.0);  // there and back at 1.25 m/s
    world.cylinders.push_back({{3.0, way < 4.0 ? -2.5 + 1.25 * way : 7.5 - 1.25 * way}, 0.25, 1.7});
    stand(server, scanner, world, 1);
    for (int deg = -85; deg <= 85; ++deg) {
      const EgoPoint& p = server.structure_map()
                              .scan()[*server.structure_map().scan().bins().index(deg_to_rad(deg))];
      ++bins;
      on_wall += p.valid && off_walls_m(p.p_base, -2, 5, -3, 3) < 0.10 ? 1 : 0;
      const Eigen::Vector3d ray = scan::beam_direction(deg_to_rad(deg), 0.0);
      const double raw = world.cast({0, 0, 0.38}, ray);
      raw_on_wall += off_walls_m((raw * ray).head<2>(), -2, 5, -3, 3) < 0.10 ? 1 : 0;
    }
  }
  EXPECT_GE(static_cast<double>(on_wall), 0.98 * static_cast<double>(bins));
  EXPECT_LT(raw_on_wall, on_wall) << "a level scan loses the wall behind the person";
}

// The confirmed rule lets a door that closes replace the wall behind it: that is no longer
// measured.
TEST(Scene, StructureMapTakesAClosedDoorOver) {
  MapServer server({});
  NoddingScanner scanner;
  stand(server, scanner, test::room(-2, 5, -3, 3), 150);
  World closed = test::room(-2, 5, -3, 3);
  closed.boxes.push_back({{3.0, -1.0, 0.0}, {3.1, 1.0, 2.5}});
  stand(server, scanner, closed, 150);
  EXPECT_TRUE(has_point_near(server.structure_map(), {5.0, 0.0}, 0.1)) << "after 2 s still open";
  stand(server, scanner, closed, 300);
  EXPECT_FALSE(has_point_near(server.structure_map(), {5.0, 0.0}, 0.1));
  EXPECT_TRUE(has_point_near(server.structure_map(), {3.0, 0.0}, 0.1));
}

// T3: a person steps before the standing robot and leaves again.
TEST(Scene, T3_PersonThatLeftGoesThoughTheRobotStands) {
  const World empty = test::room(-2, 5, -3, 3);
  World occupied = empty;
  occupied.cylinders.push_back({{1.8, 0.0}, 0.25, 1.75});
  const auto ghost_after = [&](Rule rule, int sweeps) {
    MapServer server(with_rule(rule));
    NoddingScanner scanner;
    scanner.range_sigma_m = 0.01;
    stand(server, scanner, empty, 100);
    stand(server, scanner, occupied, 100);
    EXPECT_TRUE(has_point_near(server.obstacle_map(), {1.55, 0.0}, 0.1));
    stand(server, scanner, empty, sweeps * scanner.scans_per_sweep());
    return has_point_near(server.obstacle_map(), {1.6, 0.0}, 0.4);
  };
  EXPECT_TRUE(ghost_after(Rule::kPaper, 100)) << "the naive reading never lets go of it";
  EXPECT_FALSE(ghost_after(Rule::kConfirmed, 2));
}

/// Whether the map holds the front of the box at every update, once it has seen it, until the
/// robot's bumper is there.
bool holds_until_passed(Rule rule, const Box& box, double speed_mps) {
  World world = test::room(-2, 8, -2, 2);
  world.boxes.push_back(box);
  MapServer server(with_rule(rule));
  NoddingScanner scanner;
  scanner.range_sigma_m = 0.01;
  bool seen = false;
  bool lost = false;
  const double way_m = box.low.x() - 0.225;
  drive(server, scanner, world, speed_mps, way_m / speed_mps, [&](const SE2& pose) {
    const Eigen::Vector2d front(box.low.x() - pose.x, 0.0);
    // Ten centimetres: as wide as the gaps that open between the points nearby.
    const bool held = has_point_near(server.obstacle_map(), front, 0.10);
    seen = seen || held;
    lost = lost || (seen && front.x() < 1.5 && !held);
  });
  return seen && !lost;
}

// T4, R24b: below the wedge a low box lives by memory. The paper's rule must lose it: any speed
// below d_min / 5 s does.
TEST(Scene, T4_R24b_LowBoxIsRememberedInTheBlindZone) {
  const Box low_box{{2.0, -0.2, 0.0}, {2.4, 0.2, 0.10}};
  EXPECT_FALSE(holds_until_passed(Rule::kPaper, low_box, 0.1))
      << "the naive reading drives into it";
  EXPECT_TRUE(holds_until_passed(Rule::kConfirmed, low_box, 0.1));
}

TEST(Scene, T4_R24b_AtEverySpeedAndHeight) {
  for (const double speed_mps : {0.03, 0.2, 0.5}) {
    for (const double top_m : {0.08, 0.12, 0.20, 0.30}) {
      const Box box{{2.0, -0.2, 0.0}, {2.4, 0.2, top_m}};
      EXPECT_TRUE(holds_until_passed(Rule::kConfirmed, box, speed_mps))
          << speed_mps << " m/s, " << top_m << " m high";
    }
  }
}

TEST(Scene, T4_R24b_TableTopIsRememberedAboveTheWedge) {
  const Box table_top{{2.0, -0.4, 0.42}, {2.8, 0.4, 0.46}};
  for (const double speed_mps : {0.03, 0.1, 0.5}) {
    EXPECT_TRUE(holds_until_passed(Rule::kConfirmed, table_top, speed_mps)) << speed_mps;
  }
}

// T5, R23b: a minute's drive through a corridor. Nothing moves, so nothing may become obsolete.
TEST(Scene, T5_R23b_StaticWallNeverGoes) {
  const World world = test::room(-2, 25, -1.5, 1.5);
  const auto after_a_minute = [&](Rule rule) {
    MapServer server(with_rule(rule));
    NoddingScanner scanner;
    scanner.range_sigma_m = 0.01;
    drive(server, scanner, world, 0.3, 60.0, [](const SE2&) {});
    return server;
  };
  EXPECT_GT(after_a_minute(Rule::kPaper).obstacle_map().removed(), 100U)
      << "the naive reading lets walls expire";
  const MapServer server = after_a_minute(Rule::kConfirmed);
  EXPECT_EQ(server.obstacle_map().removed(), 0U);
  // The far corner of the corridor lies behind the line between the beams beside it: hidden.
  EXPECT_LE(server.structure_map().removed(), 1U);
}

// R12, R23b: all of 120 degrees at 0.25 degrees a scan takes 6.4 s, longer than an unconfirmed
// point lives. The robot stands; nothing may go between two looks.
TEST(Scene, T5_R23b_StaticWallOutlivesASlowNod) {
  const World world = test::room(-2, 6, -2, 2);
  MapServer server(with_rule(Rule::kConfirmed));
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

// R26: the wheels slip by 5 degrees of yaw. The walls stand double, for at most five seconds.
TEST(Scene, R26_WallsDoubledByASlipBecomeOneAgain) {
  for (const Rule rule : {Rule::kPaper, Rule::kConfirmed}) {
    const World world = test::room(-2, 6, -2, 2);
    MapServer server(with_rule(rule));
    NoddingScanner scanner;
    const auto off_wall = [&](const SE2& pose) {
      return std::ranges::count_if(server.structure_map().scan().points(), [&](const EgoPoint& p) {
        const bool ahead = std::abs(p.bearing_rad) < deg_to_rad(80);
        return p.valid && ahead && off_walls_m(pose * p.p_base, -2, 6, -2, 2) > 0.10;
      });
    };
    SE2 pose;
    for (int i = 0; i * NoddingScanner::kPeriodS < 9.0; ++i) {
      const double t = i * NoddingScanner::kPeriodS;
      pose = {0.1 * t, 0, 0};
      const bool slipped = t > 3.0;
      const SE2 odometry = slipped ? pose * SE2{0, 0, deg_to_rad(5)} : pose;
      server.add_scan(scanner.scan(world, pose), geometry::to_se3(odometry));
      if (t > 3.0 && t < 3.02) {
        EXPECT_GT(off_wall(pose), 20);
      }
      if (t > 8.0 + 3 * NoddingScanner::kPeriodS) {
        ASSERT_EQ(off_wall(pose), 0) << "at " << t;
      }
    }
  }
}

// R24a with the confirmed rule, in motion: gone within two sweeps, not after five seconds.
TEST(Scene, R24a_RemovedObjectGoesWithinTwoSweepsWhileDriving) {
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
TEST(Scene, LevelScannerClearsWithinTwoScans) {
  const World empty = test::room(-2, 5, -3, 3);
  World occupied = empty;
  occupied.cylinders.push_back({{1.8, 0.0}, 0.25, 1.75});
  MapServer server({});
  NoddingScanner scanner;
  scanner.step_rad = 0.0;
  stand(server, scanner, occupied, 50);
  EXPECT_TRUE(has_point_near(server.obstacle_map(), {1.55, 0.0}, 0.1));
  stand(server, scanner, empty, 2);
  EXPECT_FALSE(has_point_near(server.obstacle_map(), {1.6, 0.0}, 0.4));
}

}  // namespace
}  // namespace nodmap::map_server
