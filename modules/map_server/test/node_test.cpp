// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/node.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/node/messages.hpp"
#include "modules/map_server/results.hpp"
#include "modules/map_server/test/world.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::map_server {
namespace node_test {

class MapServerNodeTest : public ::testing::Test {
 protected:
  explicit MapServerNodeTest(const MapServerParams& params = {}) : node_(context_, params) {}

  nodmap::scan_t next_scan() { return node::write_scan(scanner_.scan(world_, {})); }

  void give_odometry(std::int64_t utime_us, std::int64_t seq, double x = 0.0) {
    auto message = node::write_odometry(time::from_utime(utime_us), geometry::to_se3({x, 0, 0}));
    message.odometry_seq = seq;
    bus_.deliver("ODOMETRY", message);
  }

  std::int64_t rejected(const std::string& cause) {
    const auto found = counts_.rejected().find(cause);
    return found == counts_.rejected().end() ? 0 : found->second;
  }

  [[nodiscard]] std::vector<nodmap::egomap_t> maps_on(const std::string& channel) const {
    return bus_.sent<nodmap::egomap_t>(channel);
  }

  nodmap::test::MemoryBus bus_;
  node::MessageCounts counts_;
  node::Context context_{bus_, counts_, {}};
  MapServerNode node_;
  test::NoddingScanner scanner_;
  test::World world_ = test::room(-2, 5, -3, 3);
};

TEST_F(MapServerNodeTest, PublishesBothMapsAfterEveryScan) {
  give_odometry(1'000'000, 0);
  const nodmap::scan_t scan = next_scan();
  bus_.deliver("SCAN", scan);
  const auto maps = maps_on("OBSTACLE_MAP");
  ASSERT_EQ(maps.size(), 1U);
  ASSERT_EQ(maps_on("STRUCTURE_MAP").size(), 1U);
  EXPECT_EQ(maps[0].utime, scan.utime + scan.beam_duration_us / 2);
  EXPECT_EQ(maps[0].num_bins, 360);
  EXPECT_EQ(maps[0].orientation[0], 1.0);
  // The lowest line of the nod hits the floor: no obstacle ahead, but walls at the sides.
  EXPECT_EQ(maps[0].distance_m[180], std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(maps[0].point_x_m[180]));
  EXPECT_TRUE(std::isnan(maps[0].age_s[180]));
  EXPECT_NEAR(maps[0].distance_m[270], 3.0, 0.01);
  EXPECT_NEAR(maps[0].point_y_m[270], 3.0, 0.01);
  EXPECT_EQ(maps[0].age_s[270], 0.0F);
  EXPECT_EQ(counts_.total_rejected(), 0);
}

TEST_F(MapServerNodeTest, WithoutOdometryNothingIsPublished) {
  bus_.deliver("SCAN", next_scan());
  EXPECT_TRUE(maps_on("OBSTACLE_MAP").empty());
  EXPECT_EQ(rejected("scan_without_odometry"), 1);
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
}

TEST_F(MapServerNodeTest, PublishesNothingAfterOdometryHasEnded) {
  give_odometry(1'000'000, 0);
  for (int i = 0; i < 20; ++i) {
    bus_.deliver("SCAN", next_scan());
  }
  // 50 ms are four scans of 13.32 ms, counted to the middle of each.
  EXPECT_EQ(maps_on("OBSTACLE_MAP").size(), 4U);
  EXPECT_EQ(rejected("scan_without_odometry"), 16);
}

class StationaryNodeTest : public MapServerNodeTest {
 protected:
  StationaryNodeTest()
      : MapServerNodeTest([] {
          MapServerParams params;
          params.assume_stationary = true;
          return params;
        }()) {}
};

TEST_F(StationaryNodeTest, PublishesWithoutOdometryIfTheRobotIsAssumedStationary) {
  bus_.deliver("SCAN", next_scan());
  EXPECT_EQ(maps_on("OBSTACLE_MAP").size(), 1U);
}

class ScannerAsBaseNodeTest : public MapServerNodeTest {
 protected:
  ScannerAsBaseNodeTest()
      : MapServerNodeTest([] {
          MapServerParams params;
          params.base_height_m = 0.38;
          return params;
        }()) {}
};

TEST_F(ScannerAsBaseNodeTest, HeightsAreAboveTheGround) {
  give_odometry(1'000'000, 0);
  nodmap::scan_t scan = next_scan();
  scan.mount_position_m[2] = 0.0;
  bus_.deliver("SCAN", scan);
  const auto maps = maps_on("OBSTACLE_MAP");
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_NEAR(maps[0].point_z_m[270], 0.38, 2e-8);  // a float's rounding
}

TEST_F(MapServerNodeTest, ARestartOfOdometryClearsTheMaps) {
  give_odometry(1'000'000, 50, 7.0);
  bus_.deliver("SCAN", next_scan());
  give_odometry(1'010'000, 0, 0.0);  // restarted: the same place has another pose
  give_odometry(1'015'000, 1, 0.0);
  nodmap::scan_t blind = next_scan();
  blind.ranges_m.assign(blind.ranges_m.size(), std::numeric_limits<float>::quiet_NaN());
  bus_.deliver("SCAN", blind);
  const auto maps = maps_on("STRUCTURE_MAP");
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_TRUE(std::ranges::any_of(maps[0].distance_m, [](float d) { return std::isfinite(d); }));
  EXPECT_TRUE(std::ranges::none_of(maps[1].distance_m, [](float d) { return std::isfinite(d); }));
}

// From another sender, stamped a day ahead: with the number of a driver that has restarted, and
// with one that the driver has not reached yet.
TEST_F(MapServerNodeTest, OneForgedOdometryCostsNoMap) {
  constexpr std::int64_t kDayUs = 86'400'000'000;
  give_odometry(1'000'000, 50, 7.0);
  bus_.deliver("SCAN", next_scan());
  give_odometry(kDayUs, 0, 0.0);
  give_odometry(1'005'000, 51, 7.0);
  give_odometry(kDayUs, 151, 0.0);
  give_odometry(1'010'000, 52, 7.0);
  give_odometry(1'015'000, 53, 7.0);
  nodmap::scan_t blind = next_scan();
  blind.ranges_m.assign(blind.ranges_m.size(), std::numeric_limits<float>::quiet_NaN());
  bus_.deliver("SCAN", blind);
  const auto maps = maps_on("STRUCTURE_MAP");
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_TRUE(std::ranges::any_of(maps[1].distance_m, [](float d) { return std::isfinite(d); }));
  EXPECT_EQ(rejected("unconfirmed_odometry"), 2);
}

TEST_F(MapServerNodeTest, InvalidScansAreCountedAndNotUsed) {
  give_odometry(1'000'000, 0);
  nodmap::scan_t empty = next_scan();
  empty.num_ranges = 0;
  empty.ranges_m.clear();
  bus_.deliver("SCAN", empty);
  nodmap::scan_t twisted = next_scan();
  twisted.mount_orientation[0] = 0.0;
  bus_.deliver("SCAN", twisted);
  nodmap::scan_t infinite = next_scan();
  infinite.pitch_first_rad = std::numeric_limits<double>::infinity();
  bus_.deliver("SCAN", infinite);
  EXPECT_EQ(rejected("implausible_scan"), 2);
  EXPECT_EQ(rejected("empty_scan"), 1);
  EXPECT_TRUE(maps_on("OBSTACLE_MAP").empty());
  nodmap::odometry_t nowhere =
      node::write_odometry(time::from_utime(1'010'000), geometry::SE3::Identity());
  nowhere.position_m[0] = std::numeric_limits<double>::quiet_NaN();
  bus_.deliver("ODOMETRY", nowhere);
  EXPECT_EQ(rejected("implausible_odometry"), 1);
}

TEST_F(MapServerNodeTest, RandomBytesAreCountedAsCorrupt) {
  std::mt19937 random(8);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int i = 0; i < 1000; ++i) {  // 10^6 bytes
    std::vector<std::byte> bytes(1000);
    for (std::byte& b : bytes) {
      b = static_cast<std::byte>(byte(random));
    }
    bus_.deliver_bytes("SCAN", bytes);
  }
  EXPECT_EQ(bus_.counts().corrupt, 1000);
  EXPECT_TRUE(maps_on("OBSTACLE_MAP").empty());
}

TEST_F(MapServerNodeTest, LostScansAreCounted) {
  give_odometry(1'000'000, 0);
  bus_.deliver("SCAN", next_scan());
  static_cast<void>(next_scan());
  static_cast<void>(next_scan());
  bus_.deliver("SCAN", next_scan());
  EXPECT_EQ(counts_.lost(), 2);
}

TEST_F(MapServerNodeTest, WritesAnImageAndMetrics) {
  give_odometry(1'000'000, 0);
  bus_.deliver("SCAN", next_scan());
  const nodmap::test::TemporaryDir dir;
  node_.write_results(dir.path());
  EXPECT_GT(std::filesystem::file_size(dir.path() / "map.png"), 1000U);
  EXPECT_EQ(node_.metrics()["scans_used"], 1);
  EXPECT_EQ(node_.metrics()["obstacle_map"]["bins"], 360);
}

ExtendedScan map_with(Relevance relevance, const Eigen::Vector2d& p) {
  ExtendedScan map(AngleBins(geometry::deg_to_rad(360), geometry::deg_to_rad(1)), relevance);
  const EgoPoint point = EgoPoint::at(p, 0.2);
  map[*map.bins().index(point.bearing_rad)] = point;
  return map;
}

bool is_reddish(drawing::Rgb c) {
  return c[0] > 150 && c[2] < 100;
}
bool is_bluish(drawing::Rgb c) {
  return c[2] > 150 && c[0] < 100;
}

// Points at 4.5 m give an image of 5 m to each side: 100 pixels a metre. Ahead is up, left is
// left.
TEST(MapDrawing, AheadIsDrawnUpwardsAndLeftOnTheLeft) {
  const drawing::Image image =
      draw_maps(map_with(Relevance::kNearest, {2.0, 0.0}),
                map_with(Relevance::kFarthest, {0.0, 4.5}), robot::Body{}.footprint());
  EXPECT_TRUE(is_reddish(image.at(500, 300)));
  EXPECT_TRUE(is_bluish(image.at(50, 500)));
  EXPECT_EQ(image.at(500, 500), image.at(490, 515));  // the robot's body
  EXPECT_NE(image.at(500, 500), drawing::kWhite);
  EXPECT_EQ(image.at(900, 640), drawing::kWhite);
}

TEST(MapDrawing, EmptyMapsAreDrawnAsWell) {
  const ExtendedScan none(AngleBins(1.0, 0.1), Relevance::kNearest);
  EXPECT_GT(draw_maps(none, none, {}).width(), 0);
}

}  // namespace node_test
}  // namespace nodmap::map_server
