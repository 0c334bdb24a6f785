// SPDX-License-Identifier: BSD-3-Clause
// Compared with values computed by hand.
#include "modules/viewer/foxglove/sensor_views.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "modules/viewer/foxglove/test/robot_maps.hpp"
#include "modules/viewer/foxglove/test/robot_messages.hpp"

namespace nodmap::foxglove {
namespace sensor_views_test {

// An independent base64 decoder: a table, 4 characters at a time.
std::vector<std::uint8_t> decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') {
      break;
    }
    bits = (bits << 6U) | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<std::uint8_t>((bits >> count) & 0xFFU));
    }
  }
  return bytes;
}

std::vector<float> floats_in(const Json& cloud) {
  const auto bytes = decoded(cloud["data"].get<std::string>());
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

scan::Scan level_scan() {
  scan::Scan scan;
  scan.stamp = time::from_utime(5'000'000);
  scan.angle_first_rad = -0.5;
  scan.angle_step_rad = 0.5;
  scan.range_min_m = 0.1;
  scan.range_max_m = 10.0;
  scan.ranges_m = {1.5F, std::numeric_limits<float>::infinity(),
                   std::numeric_limits<float>::quiet_NaN()};
  return scan;
}

TEST(LaserScan, HasTheFanOfTheScanAndZeroForMissingReadings) {
  const Json json = laser_scan(level_scan());
  EXPECT_EQ(json["ranges"], Json({1.5, 0.0, 0.0}));
  EXPECT_DOUBLE_EQ(json["start_angle"], -0.5);
  EXPECT_DOUBLE_EQ(json["end_angle"], 0.5);
  EXPECT_EQ(json["timestamp"], time_json(time::from_utime(5'000'000)));
  EXPECT_EQ(json["frame_id"], "base");
}

// The page and Foxglove draw p_base = pose * (r cos a, r sin a, 0): the same as Eq. 1 when the
// pitch does not change during the scan.
TEST(LaserScan, PlacesABeamWhereEquation1Does) {
  scan::Scan scan = level_scan();
  scan.pitch_first_rad = scan.pitch_last_rad = 0.3;
  scan.T_base_mount.translation() = Eigen::Vector3d(0.1, 0.0, 0.4);
  scan.mirror_offset_m = Eigen::Vector3d(0.05, 0.0, 0.02);
  const Json pose = laser_scan(scan)["pose"];
  const Json& p = pose["position"];
  const Json& q = pose["orientation"];
  const Eigen::Quaterniond rotation(q["w"], q["x"], q["y"], q["z"]);
  const Eigen::Vector3d end =
      Eigen::Vector3d(p["x"], p["y"], p["z"]) +
      rotation * Eigen::Vector3d(1.5 * std::cos(-0.5), 1.5 * std::sin(-0.5), 0.0);
  // Rounding of doubles only.
  EXPECT_TRUE(end.isApprox(scan::point_in_base(scan, 0, 1.5), 1e-12));
}

TEST(EgomapCloud, ContainsTheMeasuredPointsOnly) {
  nodmap::egomap_t map = foxglove::test::egomap_at(1.0);
  const Json json = egomap_cloud(map, geometry::SE3::Identity());
  const std::vector<float> values = floats_in(json);
  const auto seen = static_cast<std::size_t>(
      std::ranges::count_if(map.distance_m, [](float d) { return std::isfinite(d); }));
  ASSERT_GT(seen, 0U);
  ASSERT_LT(seen, map.distance_m.size());
  ASSERT_EQ(values.size(), 4 * seen);
  const std::size_t first = static_cast<std::size_t>(
      std::ranges::find_if(map.distance_m, [](float d) { return std::isfinite(d); }) -
      map.distance_m.begin());
  EXPECT_EQ(values[0], map.point_x_m[first]);
  EXPECT_EQ(values[1], map.point_y_m[first]);
  EXPECT_EQ(values[2], 0.25F);
  EXPECT_EQ(values[3], 0.5F);
  EXPECT_EQ(json["point_stride"], 16);
}

TEST(PointCloud, KeepsFloatsBitByBit) {
  const std::vector<float> xyz{1.25F, -2.5e-7F, 3.0e8F};
  const Json json = point_cloud({time::from_utime(7), "map_6d", geometry::SE3::Identity(), xyz});
  EXPECT_EQ(floats_in(json), xyz);
  EXPECT_EQ(json["fields"][1], Json({{"name", "y"}, {"offset", 4}, {"type", 7}}));
}

TEST(Grid, HasTheCellsAndTheCornerOfTheMap) {
  const Json json = grid({time::from_utime(9), 0.05, -1.0, 2.0, 2, 1, {-1, 100}});
  EXPECT_EQ(decoded(json["data"]), (std::vector<std::uint8_t>{255, 100}));
  EXPECT_EQ(json["column_count"], 2);
  EXPECT_DOUBLE_EQ(json["pose"]["position"]["y"], 2.0);
  EXPECT_DOUBLE_EQ(json["cell_size"]["x"], 0.05);
}

TEST(Grid, OfTheLocalMapIsInOdom) {
  nodmap::local_map_t map = foxglove::test::local_map();
  const Json json = local_map_grid(map);
  EXPECT_EQ(json["frame_id"], "odom");
  EXPECT_EQ(decoded(json["data"])[79 * 80 + 61], nodmap::local_map_t::HOLE);
  EXPECT_DOUBLE_EQ(json["pose"]["position"]["x"], -2.0);
}

TEST(Grid, ALocalMapMustHaveAsManyCellsAsItStates) {
  const nodmap::local_map_t good = foxglove::test::local_map();
  EXPECT_TRUE(is_valid(good));
  nodmap::local_map_t bad = good;
  bad.width = 81;
  EXPECT_FALSE(is_valid(bad));
  bad = good;
  bad.width = bad.height = -80;  // only their product is right
  EXPECT_FALSE(is_valid(bad));
  bad = good;
  bad.width = 1;
  bad.height = bad.num_cells;  // longer than a map may be
  EXPECT_FALSE(is_valid(bad));
  bad = good;
  bad.cell_size_m = 0.0;
  EXPECT_FALSE(is_valid(bad));
  bad = good;
  bad.origin_m[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_valid(bad));
}

}  // namespace sensor_views_test
}  // namespace nodmap::foxglove
