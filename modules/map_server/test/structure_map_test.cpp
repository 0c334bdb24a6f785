// SPDX-License-Identifier: BSD-3-Clause
// The structure map in complete scenes: walls stay, objects in front of them disappear.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "modules/map_server/test/scene.hpp"

namespace nodmap::map_server {
namespace structure_map_test {

using test::deg_to_rad;
using test::has_point_near;
using test::NoddingScanner;
using test::off_walls_m;
using test::SE2;
using test::stay;
using test::with_rule;
using test::World;

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

// The sweeps of the pitch controller at 1.5 m/s (bench/pitch_controller_table): the corridor from
// d_min on, and one line more at each end.
NoddingScanner scanner_at_speed() {
  NoddingScanner scanner;
  scanner.low_rad = deg_to_rad(-18.4);
  scanner.high_rad = deg_to_rad(7.5);
  scanner.step_rad = deg_to_rad(1.0);
  scanner.range_sigma_m = 0.01;
  return scanner;
}

// Sweeps that end above a person and below the top of the wall, as at walking pace.
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
TEST(Scene, FurnitureDisappearsFromTheStructureMap) {
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

// Distance of a place to the nearest of the tall objects in furnished_room(): the person and the
// table legs.
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
TEST(Scene, AtSpeedObjectsTallerThanTheSweepStayInTheStructureMap) {
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

// The fraction of time for which a direction of the structure map, and of a level scan, shows the
// wall, while a person crosses ten times two metres in front of it.
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

// The same at 1.5 m/s: the wall is remembered while the person hides it.
TEST(Scene, AWalkingPersonDoesNotHideTheWall) {
  for (const NoddingScanner& scanner : {scanner_when_slow(), scanner_at_speed()}) {
    const WallShown shown = wall_shown_behind_a_walker(scanner);
    EXPECT_GE(shown.structure_map, 0.98);
    EXPECT_LT(shown.level_scan, 0.97);
  }
}

// A door that closes replaces the wall behind it, which is no longer measured.
TEST(Scene, AClosedDoorReplacesTheWallBehindIt) {
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

// The wheels slip by 5 degrees of yaw. The walls appear twice, for at most five seconds.
TEST(Scene, AfterASlipDoubledWallsBecomeOneWithinFiveSeconds) {
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

}  // namespace structure_map_test
}  // namespace nodmap::map_server
