// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/map_server.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "modules/map_server/test/world.hpp"
#include "tests/support/allocations.hpp"

namespace nodmap::map_server {
namespace map_server_test {

using geometry::SE3;
using test::deg_to_rad;
using test::NoddingScanner;
using test::SE2;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

scan::Scan random_scan(std::mt19937& random) {
  std::uniform_real_distribution<double> pitch(-60.0, 60.0);
  std::uniform_real_distribution<float> range(0.1F, 10.0F);
  NoddingScanner scanner;
  scan::Scan scan = scanner.scan({}, {});
  scan.pitch_first_rad = deg_to_rad(pitch(random));
  scan.pitch_last_rad = scan.pitch_first_rad + deg_to_rad(1);
  scan.T_base_mount.translation() = Eigen::Vector3d(0.15, 0.03, 0.38);
  for (float& r : scan.ranges_m) {
    r = range(random);
  }
  return scan;
}

// Oracle: brute force over all the points of a random cloud, bin by bin. 1e-9 is rounding.
// By the paper's rule a stationary robot keeps all points.
TEST(MapServer, NearestAndFarthestPointsOfARandomCloud) {
  MapServerParams params;
  params.update.rule = RemovalRule::kPaper;
  MapServer server(params);
  std::mt19937 random(13);
  std::vector<Eigen::Vector3d> cloud;
  for (int i = 0; i < 60; ++i) {
    const scan::Scan scan = random_scan(random);
    ASSERT_EQ(server.add_scan(scan, SE3::Identity()), ScanStatus::kUsed);
    for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
      cloud.push_back(scan::point_in_base(scan, beam, static_cast<double>(scan.ranges_m[beam])));
    }
  }
  const AngleBins& bins = server.obstacle_map().scan().bins();
  const double rise = std::tan(3 * params.noise.pitch_sigma_rad);
  std::size_t filled = 0;
  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    double nearest = test::kInfinity;
    double farthest = -test::kInfinity;
    for (const Eigen::Vector3d& p : cloud) {
      const double d = std::hypot(p.x(), p.y());
      const bool is_robot = std::abs(p.x()) < 0.225 && std::abs(p.y()) < 0.165;
      if (!is_robot && bins.index(std::atan2(p.y(), p.x())) == bin && p.z() >= 0.05 + rise * d) {
        farthest = std::max(farthest, d);
        nearest = p.z() <= 0.5 ? std::min(nearest, d) : nearest;
      }
    }
    const EgoPoint& obstacle = server.obstacle_map().scan()[bin];
    const EgoPoint& structure = server.structure_map().scan()[bin];
    ASSERT_EQ(obstacle.valid, std::isfinite(nearest)) << "bin " << bin;
    ASSERT_EQ(structure.valid, std::isfinite(farthest)) << "bin " << bin;
    EXPECT_TRUE(!obstacle.valid || std::abs(obstacle.distance_m - nearest) < 1e-9);
    EXPECT_TRUE(!structure.valid || std::abs(structure.distance_m - farthest) < 1e-9);
    filled += obstacle.valid ? 1 : 0;
  }
  EXPECT_GT(filled, 170U);
}

// At a pitch of 30 degrees a beam 35 degrees to the left hits a point whose bearing from base is 39
// degrees: it belongs in that bin, not in the beam's.
TEST(MapServer, PointsAreBinnedByTheirProjectedAngle) {
  MapServer server({});
  NoddingScanner scanner;
  scan::Scan scan = scanner.scan({}, {});
  scan.pitch_first_rad = scan.pitch_last_rad = deg_to_rad(30);
  std::ranges::fill(scan.ranges_m, std::numeric_limits<float>::infinity());
  scan.ranges_m[90 + 35] = 2.0F;
  server.add_scan(scan, SE3::Identity());
  const Eigen::Vector3d p = scan::point_in_base(scan, 90 + 35, 2.0);
  const double projected = std::atan2(p.y(), p.x());
  ASSERT_GT(projected - deg_to_rad(35), deg_to_rad(3));
  const ExtendedScan& map = server.structure_map().scan();
  EXPECT_TRUE(map[*map.bins().index(projected)].valid);
  EXPECT_FALSE(map[*map.bins().index(deg_to_rad(35))].valid);
}

TEST(MapServer, StructureMapRejectsBeamsThatDidNotReturn) {
  MapServer server({});
  NoddingScanner scanner;
  scan::Scan scan = scanner.scan(test::room(-2, 5, -3, 3), {});
  scan.pitch_first_rad = scan.pitch_last_rad = 0.0;
  std::ranges::fill(scan.ranges_m, std::numeric_limits<float>::infinity());
  scan.ranges_m[80] = 81.83F;  // CARMEN's mark
  scan.ranges_m[81] = std::numeric_limits<float>::quiet_NaN();
  scan.ranges_m[82] = -1.0F;
  scan.ranges_m[83] = 0.0F;
  EXPECT_EQ(server.add_scan(scan, SE3::Identity()), ScanStatus::kUsed);
  for (const EgoPoint& p : server.structure_map().scan().points()) {
    EXPECT_FALSE(p.valid);
  }
}

TEST(MapServer, TheRobotsOwnBodyIsNotAnObstacle) {
  MapServer server({});
  NoddingScanner scanner;
  scan::Scan scan = scanner.scan({}, {});
  scan.pitch_first_rad = scan.pitch_last_rad = deg_to_rad(-40);
  std::ranges::fill(scan.ranges_m, std::numeric_limits<float>::infinity());
  scan.ranges_m[0] = 0.10F;
  scan.ranges_m[180] = 0.17F;  // half a centimetre outside the body
  server.add_scan(scan, SE3::Identity());
  const ExtendedScan& map = server.obstacle_map().scan();
  EXPECT_FALSE(map[*map.bins().index(deg_to_rad(-90))].valid);
  EXPECT_TRUE(map[*map.bins().index(deg_to_rad(90))].valid);
}

// A shift below a micrometre counts as none, but many add up.
TEST(MapServer, ShiftsBelowAMicrometreAddUp) {
  MapServer server({});
  NoddingScanner scanner;
  scanner.step_rad = 0.0;
  const test::World wall{{{{5, -3, 0}, {5.2, 3, 2}}}, {}, true};
  server.add_scan(scanner.scan(wall, {}), SE3::Identity());
  const auto ahead = [&] {
    const ExtendedScan& map = server.obstacle_map().scan();
    return map[*map.bins().index(0.0)].distance_m;
  };
  const double before = ahead();
  scan::Scan blind = scanner.scan({}, {});
  std::ranges::fill(blind.ranges_m, std::numeric_limits<float>::quiet_NaN());
  for (int i = 1; i <= 10'000; ++i) {
    server.add_scan(blind, geometry::to_se3(SE2{0.5e-6 * i, 0, 0}));
    if (i == 1) {
      EXPECT_EQ(ahead(), before);
    }
  }
  EXPECT_NEAR(before - ahead(), 5e-3, 1e-6);
}

TEST(MapServer, AnEmptyOrInvalidScanIsRefused) {
  MapServer server({});
  NoddingScanner scanner;
  scan::Scan scan = scanner.scan(test::room(-2, 5, -3, 3), {});
  const auto refused = [&](const scan::Scan& s) {
    return server.add_scan(s, SE3::Identity()) == ScanStatus::kImplausibleScan;
  };
  scan::Scan bad = scan;
  bad.ranges_m.clear();
  EXPECT_TRUE(refused(bad));
  bad = scan;
  bad.pitch_first_rad = kNan;
  EXPECT_TRUE(refused(bad));
  bad = scan;
  bad.angle_step_rad = 0.0;
  EXPECT_TRUE(refused(bad));
  bad = scan;
  bad.T_base_mount.translation().x() = test::kInfinity;
  EXPECT_TRUE(refused(bad));
  EXPECT_FALSE(refused(scan));
}

TEST(MapServer, InvalidPosesDoNotChangeTheMaps) {
  MapServer server({});
  NoddingScanner scanner;
  const test::World world = test::room(-2, 5, -3, 3);
  server.add_scan(scanner.scan(world, {}), SE3::Identity());
  const auto distances = [&server] {
    std::vector<double> found_m;
    for (const EgoPoint& p : server.obstacle_map().scan().points()) {
      found_m.push_back(p.valid ? p.distance_m : -1.0);
    }
    return found_m;
  };
  const std::vector<double> before = distances();
  ASSERT_GT(std::ranges::count_if(before, [](double m) { return m > 0.0; }), 0);
  for (const double bad : {kNan, test::kInfinity, -test::kInfinity}) {
    SE3 pose = SE3::Identity();
    pose.translation().x() = bad;
    EXPECT_EQ(server.add_scan(scanner.scan(world, {}), pose), ScanStatus::kImplausiblePose);
    const auto after = distances();
    EXPECT_EQ(after, before);
  }
  SE3 far_away = SE3::Identity();
  far_away.translation().x() = 1e300;  // finite, but all points are out of range
  EXPECT_EQ(server.add_scan(scanner.scan(world, {}), far_away), ScanStatus::kUsed);
  for (const EgoPoint& p : server.obstacle_map().scan().points()) {
    EXPECT_FALSE(p.valid && std::isnan(p.distance_m));
  }
}

// A stamp that steps back leaves the ages unchanged.
TEST(MapServer, AStampThatStepsBackDoesNotChangeTheAges) {
  MapServer server({});
  NoddingScanner scanner;
  const test::World world = test::room(-2, 5, -3, 3);
  for (int i = 0; i < 200; ++i) {
    scan::Scan scan = scanner.scan(world, {});
    scan.stamp -= (i / 50) * 1h;
    ASSERT_EQ(server.add_scan(scan, SE3::Identity()), ScanStatus::kUsed);
    for (const EgoPoint& p : server.obstacle_map().scan().points()) {
      ASSERT_TRUE(!p.valid || (server.age_s(p) >= 0.0 && server.age_s(p) < 3.0));
    }
  }
  scan::Scan scan = scanner.scan(world, {});
  scan.stamp = time::from_utime(std::numeric_limits<std::int64_t>::min());
  scan.duration = 0s;
  EXPECT_EQ(server.add_scan(scan, SE3::Identity()), ScanStatus::kUsed);
  scan.stamp = time::from_utime(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(server.add_scan(scan, SE3::Identity()), ScanStatus::kUsed);
}

TEST(MapServer, AResetClearsTheMaps) {
  MapServer server({});
  NoddingScanner scanner;
  server.add_scan(scanner.scan(test::room(-2, 5, -3, 3), {}), SE3::Identity());
  const auto has_points = [](const auto& map) {
    return std::ranges::any_of(map.scan().points(), &EgoPoint::valid);
  };
  EXPECT_TRUE(has_points(server.obstacle_map()));
  EXPECT_TRUE(has_points(server.structure_map()));
  server.reset();
  EXPECT_FALSE(has_points(server.obstacle_map()));
  EXPECT_FALSE(has_points(server.structure_map()));
}

TEST(MapServer, TheSameScansGiveTheSameMaps) {
  const auto run = [] {
    MapServer server({});
    NoddingScanner scanner;
    scanner.range_sigma_m = 0.01;
    const test::World world = test::room(-2, 5, -3, 3);
    std::vector<double> distances;
    for (int i = 0; i < 300; ++i) {
      const SE2 pose{0.004 * i, 0, 0.001 * i};
      server.add_scan(scanner.scan(world, pose), geometry::to_se3(pose));
      for (const EgoPoint& p : server.obstacle_map().scan().points()) {
        distances.push_back(p.distance_m);
      }
    }
    return distances;
  };
  EXPECT_EQ(run(), run());
}

std::size_t allocations_after_first_scan(RemovalRule rule) {
  MapServerParams params;
  params.update.rule = rule;
  MapServer server(params);
  NoddingScanner scanner;
  const test::World world = test::room(-2, 10, -3, 3);
  std::vector<scan::Scan> scans;
  for (int i = 0; i < 500; ++i) {
    scans.push_back(scanner.scan(world, {0.004 * i, 0, 0.002 * i}));
  }
  server.add_scan(scans[0], geometry::SE3::Identity());
  nodmap::test::reset_allocations();
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const auto k = static_cast<double>(i);
    server.add_scan(scans[i], geometry::to_se3({0.004 * k, 0, 0.002 * k}));
  }
  return nodmap::test::allocations().count;
}

TEST(MapServer, AllocatesNothingAfterTheFirstScan) {
  EXPECT_EQ(allocations_after_first_scan(RemovalRule::kPaper), 0U);
  EXPECT_EQ(allocations_after_first_scan(RemovalRule::kVisibility), 0U);
}

}  // namespace map_server_test
}  // namespace nodmap::map_server
