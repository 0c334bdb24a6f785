// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/level_scan_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "common/node/messages.hpp"
#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace level_scan_reader_test {

using geometry::SE2;

// A wall two metres ahead, seen in 41 directions, the middle one of which is empty.
nodmap::egomap_t wall_at(time::Duration since_epoch) {
  nodmap::egomap_t map{};
  map.utime = time::to_us(since_epoch);
  for (int bin = -20; bin <= 20; ++bin) {
    const double y = 2.0 * std::tan(geometry::deg_to_rad(bin));
    const bool is_empty = bin == 0;
    map.distance_m.push_back(is_empty ? std::numeric_limits<float>::infinity()
                                      : static_cast<float>(std::hypot(2.0, y)));
    map.point_x_m.push_back(is_empty ? std::numeric_limits<float>::quiet_NaN() : 2.0F);
    map.point_y_m.push_back(is_empty ? std::numeric_limits<float>::quiet_NaN()
                                     : static_cast<float>(y));
  }
  map.num_bins = static_cast<std::int32_t>(map.distance_m.size());
  map.point_z_m = map.age_s = std::vector<float>(map.distance_m.size(), 0.0F);
  return map;
}

class LevelScanReaderTest : public testing::Test {
 protected:
  void put_odometry(time::Duration since_epoch, const SE2& pose) {
    auto message = node::write_odometry(time::Timestamp(since_epoch), geometry::to_se3(pose));
    message.odometry_seq = seq_++;
    reader_.read(message);
  }

  node::MessageCounts counts_;
  LevelScanReader reader_{LevelScanParams{.from_structure_map = true, .structure_period_s = 0.3},
                          counts_};
  std::int64_t seq_ = 0;
};

TEST_F(LevelScanReaderTest, AStructureMapIsAScanFromBase) {
  put_odometry(990ms, {1.0, 0.0, 0.0});
  put_odometry(1010ms, {1.1, 0.0, 0.0});
  const auto scan = reader_.read(wall_at(1s));
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->stamp, time::Timestamp(1s));
  EXPECT_NEAR(scan->T_odom_base.x, 1.05, 1e-9);
  EXPECT_TRUE(scan->sensor_origin_base.isZero());
  EXPECT_FALSE(scan->is_of_nod);
  ASSERT_EQ(scan->points_base.size(), 40U);
  for (const OrientedPoint& point : scan->points_base) {
    EXPECT_EQ(point.p.x(), 2.0);
    EXPECT_LT((point.normal - Eigen::Vector2d(-1.0, 0.0)).norm(), 1e-6);  // float coordinates
  }
}

TEST_F(LevelScanReaderTest, OneStructureMapInEachPeriodIsUsed) {
  std::vector<time::Duration> used;
  for (time::Duration t = 0ms; t <= 1s; t += 50ms) {
    put_odometry(t, {});
    if (reader_.read(wall_at(t))) {
      used.push_back(t);
    }
  }
  EXPECT_EQ(used, (std::vector<time::Duration>{0ms, 300ms, 600ms, 900ms}));
}

TEST_F(LevelScanReaderTest, ScansAreNotMatchedAsWell) {
  put_odometry(0ms, {});
  reader_.read(node::write_scan(test::Scanner().scan(test::room(), {}, time::Timestamp(0s))));
  EXPECT_FALSE(reader_.next());
  EXPECT_EQ(reader_.scan_stamp(), time::Timestamp(0s));
}

TEST_F(LevelScanReaderTest, AStructureMapWithoutOdometryOrWithAWrongPointIsCounted) {
  EXPECT_FALSE(reader_.read(wall_at(0s)));
  EXPECT_EQ(counts_.rejected().at("scan_without_odometry"), 1);
  put_odometry(1s, {});
  nodmap::egomap_t map = wall_at(1s);
  map.point_x_m.back() = 1.0F;
  EXPECT_FALSE(reader_.read(map));
  EXPECT_EQ(counts_.rejected().at("implausible_structure_map"), 1);
  EXPECT_TRUE(reader_.read(wall_at(1s)));  // the refused one did not count as used
}

}  // namespace level_scan_reader_test
}  // namespace nodmap::slam2d
