// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/node/messages.hpp"
#include "modules/slam2d/grid/map_file.hpp"
#include "modules/slam2d/localiser_node.hpp"
#include "modules/slam2d/test/slam2d_node_fixture.hpp"
#include "nodmap/clear_request_t.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/pose_graph_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::slam2d {
namespace node_test {

using test::Slam2dNodeTest;

TEST_F(Slam2dNodeTest, PublishesAPoseForEachLevelScanAndTheMap) {
  geometry::SE2 truth;
  for (std::int64_t i = 0; i < 30; ++i) {
    const time::Duration since_epoch = 200ms * i;
    const geometry::SE2 odom{1.05 * truth.x, truth.y, truth.yaw};
    put_odometry(since_epoch, odom);
    put_scan(since_epoch, truth);
    const auto poses = bus_.sent<nodmap::pose_t>("POSE_2D");
    ASSERT_EQ(poses.size(), static_cast<std::size_t>(i + 1));
    EXPECT_EQ(poses.back().utime, time::to_us(since_epoch));
    EXPECT_NEAR(poses.back().position_m[0], truth.x, 0.03);  // scan noise 1 cm
    EXPECT_EQ(poses.back().state, nodmap::pose_t::TRACKING);
    truth = truth * geometry::SE2{0.03, 0.0, 0.04};
  }
  node_.finish();
  const auto tiles = bus_.sent<nodmap::grid_chunk_t>("MAP_2D");
  ASSERT_FALSE(tiles.empty());
  EXPECT_EQ(tiles.front().map_revision, 0);
  EXPECT_EQ(tiles.back().map_revision, 6);  // at the start, after each second, at the end
  EXPECT_EQ(tiles.back().chunk_index, tiles.back().num_chunks - 1);
  for (const nodmap::grid_chunk_t& tile : tiles) {
    EXPECT_LT(tile.getEncodedSize(), 65'536);
    EXPECT_EQ(tile.num_cells, tile.tile_width * tile.tile_height);
    EXPECT_EQ(
        tile.utime,
        (std::array{0, 5, 10, 15, 20, 25, 29}.at(static_cast<std::size_t>(tile.map_revision))) *
            200'000);
  }
  EXPECT_EQ(counts_.used(), 60);
  EXPECT_EQ(node_.metrics()["scans_used"], 30);
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
}

TEST_F(Slam2dNodeTest, PublishesThePoseWithItsCovariance) {
  put_odometry(0s, {});
  put_scan(0s, {});
  put_odometry(200ms, {0.1, 0.0, 0.0});
  put_scan(200ms, {0.1, 0.0, 0.0});
  const auto pose = bus_.last<nodmap::pose_t>("POSE_2D");
  EXPECT_GT(pose.covariance[0][0], 0.0);
  EXPECT_LT(pose.covariance[0][0], 0.05 * 0.05);  // a room: centimetres
  EXPECT_GT(pose.covariance[5][5], 0.0);
  EXPECT_NEAR(pose.covariance[0][1], pose.covariance[1][0], 1e-12);
  EXPECT_EQ(pose.covariance[2][2], 0.0);  // z
  EXPECT_EQ(pose.covariance[3][3], 0.0);  // roll
}

// The robot drives round and round in a room: submaps see the same walls and are joined by loop
// closures.
TEST_F(Slam2dNodeTest, PublishesAChangedPoseGraphAtMostOnceASecond) {
  geometry::SE2 truth;
  for (std::int64_t i = 0; i < 400; ++i) {
    put_odometry(200ms * i, truth);
    put_scan(200ms * i, truth);
    truth = truth * geometry::SE2{0.03, 0.0, 0.04};
  }
  node_.finish();
  const auto graphs = bus_.sent<nodmap::pose_graph_t>("POSE_GRAPH");
  ASSERT_GT(graphs.size(), 2U);
  for (std::size_t i = 1; i + 1 < graphs.size(); ++i) {
    EXPECT_GE(graphs[i].utime - graphs[i - 1].utime, 1'000'000);
  }
  const nodmap::pose_graph_t& last = graphs.back();
  EXPECT_GT(last.num_submaps, 3);
  ASSERT_GT(last.num_loops, 0);
  int accepted = 0;
  for (std::size_t i = 0; i < last.from_submap.size(); ++i) {
    EXPECT_LT(last.from_submap[i], last.to_submap[i]);
    EXPECT_LT(last.to_submap[i], last.num_submaps);
    accepted += last.loop_state[i] == nodmap::pose_graph_t::ACCEPTED ? 1 : 0;
  }
  EXPECT_GT(accepted, 0);
  const std::size_t count = graphs.size();
  node_.finish();
  EXPECT_EQ(bus_.sent<nodmap::pose_graph_t>("POSE_GRAPH").size(), count) << "nothing has changed";
}

// The number of known cells within a rectangle of map, in the newest version of each tile.
int num_known(const std::vector<nodmap::grid_chunk_t>& chunks, const Region& region) {
  std::map<std::pair<int, int>, nodmap::grid_chunk_t> newest;
  for (const nodmap::grid_chunk_t& chunk : chunks) {
    newest[{chunk.tile_x, chunk.tile_y}] = chunk;
  }
  int known = 0;
  for (const auto& [place, tile] : newest) {
    for (int i = 0; i < tile.num_cells; ++i) {
      const double x_m = tile.origin_x_m + tile.cell_size_m * (tile.tile_x + i % tile.tile_width);
      const double y_m = tile.origin_y_m + tile.cell_size_m * (tile.tile_y + i / tile.tile_width);
      const bool is_in = x_m >= region.low.x() && x_m < region.high.x() && y_m >= region.low.y() &&
                         y_m < region.high.y();
      known += is_in && tile.cells[static_cast<std::size_t>(i)] != OccupancyGrid::kUnknown ? 1 : 0;
    }
  }
  return known;
}

TEST_F(Slam2dNodeTest, ClearsARegionOnRequestAndSavesItAsCleared) {
  const nodmap::test::TemporaryDir dir;
  context_.out_dir = dir.path();
  put_odometry(0s, {});
  put_scan(0s, {});
  const Region region{{1.0, -1.0}, {2.0, 0.0}};  // in front of the robot
  // All its cells of 5 cm.
  ASSERT_EQ(num_known(bus_.sent<nodmap::grid_chunk_t>("MAP_2D"), region), 20 * 20);
  nodmap::clear_request_t request{};
  Eigen::Map<Eigen::Vector2d>(request.low_m) = region.low;
  Eigen::Map<Eigen::Vector2d>(request.high_m) = region.high;
  bus_.deliver("CLEAR_REQUEST", request);
  put_odometry(1100ms, {});
  put_scan(1100ms, {});
  EXPECT_EQ(num_known(bus_.sent<nodmap::grid_chunk_t>("MAP_2D"), region), 0);
  bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  node::MessageCounts counts;
  nodmap::test::MemoryBus bus;
  node::Context context{bus, counts, {}};
  Slam2dNode next{context, Slam2dParams{}, {{}, dir.path(), std::nullopt}};
  next.finish();
  EXPECT_EQ(num_known(bus.sent<nodmap::grid_chunk_t>("MAP_2D"), region), 0);
  EXPECT_EQ(num_known(bus.sent<nodmap::grid_chunk_t>("MAP_2D"), {{0.0, 0.5}, {2.0, 2.0}}), 40 * 30);

  request.low_m[0] = std::numeric_limits<double>::quiet_NaN();
  bus_.deliver("CLEAR_REQUEST", request);
  EXPECT_EQ(counts_.rejected().at("implausible_clear_request"), 1);
}

TEST_F(Slam2dNodeTest, WritesALineForEachUsedScanWithItsOwnStamp) {
  // Stamps step back, as in one of the recordings. Scans are used in the order in which they come,
  // and each keeps its stamp.
  const std::vector<time::Duration> since_epoch{1'000'001us, 1200ms, 900'003us, 1400ms};
  for (const time::Duration duration : since_epoch) {
    put_odometry(duration, {});
    put_scan(duration, {});
  }
  node_.finish();
  const nodmap::test::TemporaryDir dir;
  node_.write_results(dir.path());
  for (const char* name : {"trajectory.tum", "online.tum"}) {
    const formats::Trajectory trajectory = formats::read_tum(dir.path() / name);
    ASSERT_EQ(trajectory.size(), since_epoch.size());
    for (std::size_t i = 0; i < since_epoch.size(); ++i) {
      EXPECT_EQ(trajectory[i].stamp, time::Timestamp(since_epoch[i]));
    }
  }
  for (const char* name : {"map.pgm", "map.yaml", "map.png", "path.png"}) {
    EXPECT_TRUE(std::filesystem::exists(dir.path() / name)) << name;
  }
}

TEST_F(Slam2dNodeTest, AResultThatCannotBeWrittenCostsNoOther) {
  put_odometry(0s, {});
  put_scan(0s, {});
  node_.finish();
  const nodmap::test::TemporaryDir dir;
  std::filesystem::create_directory(dir.path() / "trajectory.tum");
  EXPECT_THROW(node_.write_results(dir.path()), std::runtime_error);
  for (const char* name :
       {"map.pgm", "map.yaml", "keyframes.lcmlog", "online.tum", "map.png", "path.png"}) {
    EXPECT_TRUE(std::filesystem::exists(dir.path() / name)) << name;
  }
}

TEST_F(Slam2dNodeTest, CountsRejectedMessagesByCause) {
  put_scan(0s, {});  // before any odometry
  nodmap::scan_t broken = node::write_scan(scanner_.scan(test::room(), {}));
  broken.angle_step_rad = 0.0;
  bus_.deliver("SCAN", broken);
  put_odometry(0s, {});
  nodmap::odometry_t no_pose{};
  bus_.deliver("ODOMETRY", no_pose);
  scan::Scan blind = scanner_.scan({}, {});
  blind.seq = 1;
  bus_.deliver("SCAN", node::write_scan(blind));
  scan::Scan tilted = scanner_.scan(test::room(), {});
  tilted.seq = 5;  // three were lost
  tilted.pitch_first_rad = tilted.pitch_last_rad = -0.3;
  bus_.deliver("SCAN", node::write_scan(tilted));

  EXPECT_EQ(counts_.rejected().at("scan_without_odometry"), 1);
  EXPECT_EQ(counts_.rejected().at("implausible_scan"), 1);
  EXPECT_EQ(counts_.rejected().at("implausible_odometry"), 1);
  EXPECT_EQ(counts_.rejected().at("too_few_points"), 1);
  EXPECT_EQ(counts_.lost(), 3);
  EXPECT_EQ(node_.metrics()["scans_not_level"], 1);
  EXPECT_TRUE(bus_.sent<nodmap::pose_t>("POSE_2D").empty());
}

TEST_F(Slam2dNodeTest, WritesResultsWithoutAnyInput) {
  node_.finish();
  const nodmap::test::TemporaryDir dir;
  node_.write_results(dir.path());
  EXPECT_TRUE(formats::read_tum(dir.path() / "trajectory.tum").empty());
  EXPECT_EQ(node_.metrics()["scans_used"], 0);
}

TEST_F(Slam2dNodeTest, ReportsDegradedHealthWhenLost) {
  put_odometry(0s, {});
  put_scan(0s, {});
  put_odometry(9s, {50.0, 0.0, 0.0});  // as fast as odometry is believed
  put_scan(9s, {});
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
}

// The page and the explorer have the map, also while nothing is mapped.
TEST_F(Slam2dNodeTest, ALocaliserPublishesTheMapThatItReads) {
  const nodmap::test::TemporaryDir dir;
  const OccupancyGrid grid = test::drawn_grid(test::room(), test::poses_in_room());
  ASSERT_FALSE(write_ros_map(dir.path(), grid));
  nodmap::test::MemoryBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, {}};
  LocaliserNode localiser{context, Slam2dParams{}, {dir.path(), {}, geometry::SE2{}}};
  bus.deliver("ODOMETRY",
              node::write_odometry(time::Timestamp(1s), geometry::to_se3(geometry::SE2{})));
  bus.deliver("SCAN", node::write_scan(scanner_.scan(test::room(), {}, time::Timestamp(1s))));
  localiser.finish();
  const auto tiles = bus.sent<nodmap::grid_chunk_t>("MAP_2D");
  ASSERT_FALSE(tiles.empty());
  const TrinaryGrid saved = trinary(grid);
  std::size_t num_known = 0;
  for (const nodmap::grid_chunk_t& tile : tiles) {
    ASSERT_EQ(tile.utime, 1'000'000);
    for (std::int32_t i = 0; i < tile.num_cells; ++i) {
      const Eigen::Vector2d p_map(
          tile.origin_x_m + (tile.tile_x + i % tile.tile_width + 0.5) * tile.cell_size_m,
          tile.origin_y_m + (tile.tile_y + i / tile.tile_width + 0.5) * tile.cell_size_m);
      const Eigen::Vector2d cell = (p_map - saved.T_map_grid.translation()) / saved.cell_size_m;
      const std::int8_t occupancy = tile.cells[static_cast<std::size_t>(i)];
      const CellState state = occupancy == OccupancyGrid::kUnknown    ? CellState::kUnknown
                              : OccupancyGrid::is_occupied(occupancy) ? CellState::kOccupied
                                                                      : CellState::kFree;
      ASSERT_EQ(state, saved.at(static_cast<int>(std::floor(cell.x())),
                                static_cast<int>(std::floor(cell.y()))));
      num_known += state == CellState::kUnknown ? 0 : 1;
    }
  }
  EXPECT_EQ(num_known, static_cast<std::size_t>(std::ranges::count_if(
                           saved.cells, [](CellState s) { return s != CellState::kUnknown; })));
}

// In a map that is only read, the path is bounded as it is while mapping.
TEST_F(Slam2dNodeTest, ALocaliserKeepsAtMostMaxScansOfThePath) {
  const nodmap::test::TemporaryDir dir;
  ASSERT_FALSE(write_ros_map(dir.path(), test::drawn_grid(test::room(), test::poses_in_room())));
  nodmap::test::MemoryBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, {}};
  LocaliserNode localiser{
      context, Slam2dParams{.path = {.max_scans = 4}}, {dir.path(), {}, geometry::SE2{}}};
  for (std::int64_t i = 0; i < 10; ++i) {
    const time::Timestamp stamp(200ms * i);
    const geometry::SE2 truth{0.05 * static_cast<double>(i), 0.0, 0.0};
    auto odometry = node::write_odometry(stamp, geometry::to_se3(truth));
    odometry.odometry_seq = i;
    bus.deliver("ODOMETRY", odometry);
    scan::Scan scan = scanner_.scan(test::room(), truth, stamp);
    scan.seq = i;
    bus.deliver("SCAN", node::write_scan(scan));
  }
  ASSERT_EQ(localiser.metrics()["scans_tracked"], 10);
  localiser.write_results(dir.path());
  const formats::Trajectory trajectory = formats::read_tum(dir.path() / "trajectory.tum");
  ASSERT_EQ(trajectory.size(), 3U);  // every fourth
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_EQ(trajectory[i].stamp, time::Timestamp(800ms * i));
    EXPECT_NEAR(trajectory[i].pose.translation().x(), 0.2 * static_cast<double>(i),
                0.05);  // a cell
  }
}

// The base driver is killed and restarted: its sequence numbers and its pose begin at zero again.
TEST_F(Slam2dNodeTest, ContinuesAtItsPoseWhenOdometryRestarts) {
  const geometry::SE2 step{0.04, 0.0, 0.04};
  geometry::SE2 truth;
  geometry::SE2 odom;
  for (std::int64_t i = 0; i < 30; ++i) {
    const time::Duration since_epoch = 200ms * i;
    if (i == 15) {
      odometry_seq_ = 0;
      odom = {};
      put_odometry(since_epoch - 10ms, odom);
    }
    put_odometry(since_epoch, odom);
    put_scan(since_epoch, truth);
    const nodmap::pose_t pose = bus_.sent<nodmap::pose_t>("POSE_2D").back();
    EXPECT_EQ(pose.state, nodmap::pose_t::TRACKING) << i;
    // Scan noise is 1 cm; at the restart the guess lacks one step.
    EXPECT_NEAR(pose.position_m[0], truth.x, 0.03) << i;
    EXPECT_NEAR(pose.position_m[1], truth.y, 0.03) << i;
    // With odometry as it is published, from which others continue until the next pose.
    const auto T_map_odom = node::read_pose(pose.odom_position_m, pose.odom_orientation);
    ASSERT_TRUE(T_map_odom) << i;
    const geometry::SE2 map_from_odom = geometry::to_se2(*T_map_odom) * odom;
    EXPECT_NEAR(map_from_odom.x, pose.position_m[0], 1e-9) << i;
    EXPECT_NEAR(map_from_odom.y, pose.position_m[1], 1e-9) << i;
    truth = truth * step;
    odom = odom * step;
  }
  EXPECT_GT(truth.translation().norm(), 0.5);  // far from where odometry began anew
  EXPECT_EQ(node_.metrics()["localisation"]["searches"], 0);
}

// A scan between the last odometry of the old frame and the first of the new one has no pose:
// interpolation between the two frames has no meaning.
TEST_F(Slam2dNodeTest, RejectsScansBetweenTwoOdometryFrames) {
  put_odometry(0s, {3.0, 0.0, 0.0});
  put_odometry(10ms, {3.0, 0.0, 0.0});
  put_scan(0s, {});
  odometry_seq_ = 0;
  put_odometry(390ms, {});
  put_odometry(400ms, {});
  put_scan(200ms, {});
  EXPECT_EQ(counts_.rejected().at("scan_without_odometry"), 1);
  EXPECT_EQ(bus_.sent<nodmap::pose_t>("POSE_2D").size(), 1U);
}

}  // namespace node_test
}  // namespace nodmap::slam2d
