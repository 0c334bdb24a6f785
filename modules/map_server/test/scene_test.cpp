// SPDX-License-Identifier: BSD-3-Clause
// Tests both update rules in complete scenes: a nodding scanner in a ray-cast world.
#include <gtest/gtest.h>

#include <functional>

#include "modules/map_server/map_server.hpp"
#include "modules/map_server/test/world.hpp"

namespace nodmap::map_server {
namespace scene_test {

using test::Box;
using test::deg_to_rad;
using test::NoddingScanner;
using test::SE2;
using test::World;

MapServerParams with_rule(RemovalRule rule) {
  MapServerParams params;
  params.update.rule = rule;
  return params;
}

bool has_point_near(const EgoMap& map, const Eigen::Vector2d& p_base, double radius_m) {
  return std::ranges::any_of(map.scan().points(), [&](const EgoPoint& p) {
    return p.valid && (p.p_base - p_base).norm() < radius_m;
  });
}

void stay(MapServer& server, NoddingScanner& scanner, const World& world, int scans) {
  for (int i = 0; i < scans; ++i) {
    ASSERT_EQ(server.add_scan(scanner.scan(world, {}), geometry::SE3::Identity()),
              ScanStatus::kUsed);
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

/// Distance of a place inside test::room to the nearest of its four walls.
double off_walls_m(const Eigen::Vector2d& p, double x0, double x1, double y0, double y1) {
  return std::min(
      {std::abs(p.x() - x0), std::abs(p.x() - x1), std::abs(p.y() - y0), std::abs(p.y() - y1)});
}

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
TEST(Scene, FlatFloorIsNoObstacle) {
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

/// The sweeps of the pitch controller at 1.5 m/s (bench/pitch_controller_table): the corridor from
/// d_min on, and one line more at each end.
NoddingScanner scanner_at_speed() {
  NoddingScanner scanner;
  scanner.low_rad = deg_to_rad(-18.4);
  scanner.high_rad = deg_to_rad(7.5);
  scanner.step_rad = deg_to_rad(1.0);
  scanner.range_sigma_m = 0.01;
  return scanner;
}

/// Sweeps that end above a person and below the top of the wall, as at walking pace.
NoddingScanner scanner_when_slow() {
  NoddingScanner scanner = scanner_at_speed();
  scanner.low_rad = deg_to_rad(-30);
  scanner.high_rad = deg_to_rad(28);
  return scanner;
}

bool is_on_wall(const EgoPoint& p, double tolerance_m) {
  return p.valid && off_walls_m(p.p_base, -2, 5, -3, 3) < tolerance_m;
}

// The paper's Fig. 4: objects that do not extend over the whole height disappear from the structure
// map and stay in the obstacle map.
TEST(Scene, FurnitureVanishesFromTheStructureMap) {
  for (const RemovalRule rule : {RemovalRule::kPaper, RemovalRule::kVisibility}) {
    MapServer server(with_rule(rule));
    NoddingScanner scanner = scanner_when_slow();
    stay(server, scanner, furnished_room(), 2 * scanner.scans_per_sweep());
    int valid = 0;
    int on_wall = 0;
    for (const EgoPoint& p : server.structure_map().scan().points()) {
      valid += p.valid ? 1 : 0;
      on_wall += is_on_wall(p, 0.05) ? 1 : 0;
    }
    EXPECT_GE(valid, 175);
    EXPECT_GE(on_wall, 0.95 * valid);
    const EgoMap& obstacles = server.obstacle_map();
    EXPECT_TRUE(has_point_near(obstacles, {2.95, -1.5}, 0.06)) << "person";
    EXPECT_TRUE(has_point_near(obstacles, {2.2, -0.4}, 0.06)) << "chair";
    EXPECT_TRUE(has_point_near(obstacles, {2.0, 0.525}, 0.06)) << "leg of the table";
  }
}

/// Distance of a place to the nearer of person and table legs in furnished_room().
double off_what_is_tall_m(const Eigen::Vector2d& p) {
  double nearest_m = std::abs((p - Eigen::Vector2d(3.2, -1.5)).norm() - 0.25);
  for (const double x : {2.025, 2.975}) {
    for (const double y : {0.525, 1.675}) {
      nearest_m = std::min(nearest_m, (p - Eigen::Vector2d(x, y)).norm());
    }
  }
  return nearest_m;
}

// At 1.5 m/s the sweeps end at 0.64 m above the floor two metres ahead: the person and the legs of
// the table reach higher and hide the wall, in 13 of 181 directions. The chair and the table top
// disappear.
TEST(Scene, AtSpeedWhatIsTallerThanTheSweepStaysInTheStructureMap) {
  MapServer server({});
  NoddingScanner scanner = scanner_at_speed();
  stay(server, scanner, furnished_room(), 2 * scanner.scans_per_sweep());
  int valid = 0;
  int off_wall = 0;
  for (const EgoPoint& p : server.structure_map().scan().points()) {
    valid += p.valid ? 1 : 0;
    if (p.valid && !is_on_wall(p, 0.05)) {
      ++off_wall;
      EXPECT_LT(off_what_is_tall_m(p.p_base), 0.06) << p.p_base.transpose();
    }
  }
  EXPECT_GE(valid, 175);
  EXPECT_GT(off_wall, 0);
  EXPECT_LE(off_wall, 16);  // 1.25 times as many
}

/// The fraction of time for which a direction of the structure map, and of a level scan, shows the
/// wall, while a person crosses ten times two metres in front of it.
struct WallShown {
  double structure_map = 0.0;
  double level_scan = 0.0;
};

WallShown wall_shown_behind_a_walker(NoddingScanner scanner) {
  MapServer server({});
  const World empty = test::room(-2, 5, -3, 3);
  stay(server, scanner, empty, 2 * scanner.scans_per_sweep());
  const ExtendedScan& map = server.structure_map().scan();
  int bins = 0;
  int on_wall = 0;
  int level_on_wall = 0;
  for (int i = 0; i * NoddingScanner::kPeriodS < 40.0; ++i) {
    const double t = std::fmod(i * NoddingScanner::kPeriodS, 8.0);  // there and back at 1.25 m/s
    World world = empty;
    world.cylinders.push_back({{3.0, t < 4.0 ? -2.5 + 1.25 * t : 7.5 - 1.25 * t}, 0.25, 1.7});
    stay(server, scanner, world, 1);
    for (int deg = -85; deg <= 85; ++deg) {
      ++bins;
      on_wall += is_on_wall(map[*map.bins().index(deg_to_rad(deg))], 0.10) ? 1 : 0;
      const Eigen::Vector3d ray = scan::beam_direction(deg_to_rad(deg), 0.0);
      const double level_m = world.cast({0, 0, 0.38}, ray);
      level_on_wall += off_walls_m((level_m * ray).head<2>(), -2, 5, -3, 3) < 0.10 ? 1 : 0;
    }
  }
  return {static_cast<double>(on_wall) / bins, static_cast<double>(level_on_wall) / bins};
}

// Also at 1.5 m/s: the wall is remembered while the person hides it.
TEST(Scene, AWalkingPersonDoesNotHideTheWall) {
  for (const NoddingScanner& scanner : {scanner_when_slow(), scanner_at_speed()}) {
    const WallShown shown = wall_shown_behind_a_walker(scanner);
    EXPECT_GE(shown.structure_map, 0.98);
    EXPECT_LT(shown.level_scan, 0.97);
  }
}

// A door that closes replaces the wall behind it, which is no longer measured.
TEST(Scene, StructureMapTakesAClosedDoorOver) {
  MapServer server({});
  NoddingScanner scanner;
  stay(server, scanner, test::room(-2, 5, -3, 3), 150);
  World closed = test::room(-2, 5, -3, 3);
  closed.boxes.push_back({{3.0, -1.0, 0.0}, {3.1, 1.0, 2.5}});
  stay(server, scanner, closed, 150);
  EXPECT_TRUE(has_point_near(server.structure_map(), {5.0, 0.0}, 0.1)) << "after 2 s still open";
  stay(server, scanner, closed, 300);
  EXPECT_FALSE(has_point_near(server.structure_map(), {5.0, 0.0}, 0.1));
  EXPECT_TRUE(has_point_near(server.structure_map(), {3.0, 0.0}, 0.1));
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

/// Whether the map contains the front of the box at every update from its first measurement until
/// the robot's bumper reaches it.
bool holds_until_passed(RemovalRule rule, const Box& box, double speed_mps) {
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

/// A minute's drive through a corridor in which nothing moves.
struct CorridorDrive {
  std::size_t obstacles_removed = 0;
  std::size_t structure_removed = 0;
  /// Number of dummies within 85 degrees of ahead in the obstacle map, over all updates.
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
TEST(Scene, StaticWallOutlivesASlowNod) {
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

// The wheels slip by 5 degrees of yaw. The walls appear twice, for at most five seconds.
TEST(Scene, WallsDoubledByASlipBecomeOneAgain) {
  for (const RemovalRule rule : {RemovalRule::kPaper, RemovalRule::kVisibility}) {
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

// By the visibility rule an object that is taken away is removed within two sweeps, not after five
// seconds.
TEST(Scene, RemovedObjectGoesWithinTwoSweepsWhileDriving) {
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
  stay(server, scanner, occupied, 50);
  EXPECT_TRUE(has_point_near(server.obstacle_map(), {1.55, 0.0}, 0.1));
  stay(server, scanner, empty, 2);
  EXPECT_FALSE(has_point_near(server.obstacle_map(), {1.6, 0.0}, 0.4));
}

}  // namespace scene_test
}  // namespace nodmap::map_server
