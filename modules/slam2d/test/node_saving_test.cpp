// SPDX-License-Identifier: BSD-3-Clause
// What 2D SLAM's process saves on request, and what it does when it cannot.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <future>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "common/formats/atomic_file.hpp"
#include "common/node/messages.hpp"
#include "modules/slam2d/back_end/saved_map_file.hpp"
#include "modules/slam2d/grid/map_file.hpp"
#include "modules/slam2d/node.hpp"
#include "modules/slam2d/test/slam2d_node_fixture.hpp"
#include "nodmap/save_request_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::slam2d {
namespace node_saving_test {

using test::Slam2dNodeTest;

TEST_F(Slam2dNodeTest, TriesAgainToSaveAMapThatCouldNotBeSaved) {
  const nodmap::test::TemporaryDir dir;
  context_.out_dir = dir.path() / "not_there_yet";
  put_odometry(0s, {});
  put_scan(0s, {});
  bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
  std::filesystem::create_directory(context_.out_dir);
  put_odometry(9s, {});
  put_scan(9s, {});
  EXPECT_FALSE(std::filesystem::exists(context_.out_dir / "map.pgm")) << "not at once";
  put_odometry(10s, {});
  put_scan(10s, {});
  EXPECT_TRUE(std::filesystem::exists(context_.out_dir / "map.pgm"));
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
}

TEST_F(Slam2dNodeTest, TriesAgainToSaveAlsoWhileTheRobotHasNotBeenFound) {
  const nodmap::test::TemporaryDir dir;
  put_odometry(0s, {});
  put_scan(0s, {});
  const std::filesystem::path first = dir.path() / "first";
  std::filesystem::create_directory(first);
  node_.write_results(first);
  nodmap::test::MemoryBus bus;
  node::Context context{bus, counts_, dir.path() / "not_there_yet"};
  const Slam2dNode next{context, Slam2dParams{}, {{}, first, std::nullopt}};
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  EXPECT_EQ(next.health().state, node::HealthState::kDegraded);
  std::filesystem::create_directory(context.out_dir);
  // Without odometry no scan can be placed.
  bus.deliver("SCAN", node::write_scan(scanner_.scan(test::room(), {}, time::Timestamp(9s))));
  EXPECT_FALSE(std::filesystem::exists(context.out_dir / "map.pgm")) << "not at once";
  bus.deliver("SCAN", node::write_scan(scanner_.scan(test::room(), {}, time::Timestamp(10s))));
  EXPECT_TRUE(std::filesystem::exists(context.out_dir / "map.pgm"));
}

TEST_F(Slam2dNodeTest, SavesItsMapOnRequest) {
  const nodmap::test::TemporaryDir dir;
  put_odometry(0s, {});
  put_scan(0s, {});
  bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  EXPECT_EQ(counts_.rejected().at("save_request_without_out_dir"), 1);
  context_.out_dir = dir.path();
  bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
  EXPECT_GT(std::filesystem::file_size(context_.out_dir / "map.pgm"), 1000U);
  EXPECT_TRUE(std::filesystem::exists(context_.out_dir / "map.yaml"));
}

TEST_F(Slam2dNodeTest, AFailedSaveLeavesTheOldMapAndIsReported) {
  const nodmap::test::TemporaryDir dir;
  put_odometry(0s, {});
  put_scan(0s, {});
  context_.out_dir = dir.path();
  bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  const auto size = std::filesystem::file_size(dir.path() / "map.pgm");
  // The new map is first written under this name.
  std::filesystem::create_directory(dir.path() / "map.pgm.part");
  put_odometry(10s, {});
  put_scan(10s, {});
  bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(std::filesystem::file_size(dir.path() / "map.pgm"), size);
  std::filesystem::remove(dir.path() / "map.pgm.part");
  put_odometry(20s, {});
  put_scan(20s, {});
  bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
}

std::string contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

// The disk is a pipe that nobody reads, so that saving does not end before the scans have.
TEST_F(Slam2dNodeTest, LiveNoScanWaitsUntilTheMapIsSaved) {
  const nodmap::test::TemporaryDir dir;
  const std::filesystem::path pipe = formats::unfinished_name(dir.path() / "map.pgm");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  nodmap::test::MemoryBus bus;
  node::Context context{bus, counts_, dir.path(), node::ResultsUsed::kWhenReady};
  Slam2dNode live(context, Slam2dParams{});
  const auto put = [&](std::int64_t i) {
    const time::Timestamp stamp(100ms * i);
    auto odometry = node::write_odometry(stamp, geometry::to_se3(geometry::SE2{}));
    odometry.odometry_seq = i;
    bus.deliver("ODOMETRY", odometry);
    scan::Scan scan = scanner_.scan(test::room(), {}, stamp);
    scan.seq = i;
    bus.deliver("SCAN", node::write_scan(scan));
  };
  put(0);
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  for (std::int64_t i = 1; i < 120; ++i) {
    put(i);
  }
  EXPECT_EQ(bus.count("POSE_2D"), 120U);
  EXPECT_EQ(counts_.used(), 241);
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});  // waits for the first
  put(120);
  EXPECT_EQ(bus.count("POSE_2D"), 121U);
  const auto drained = std::async(std::launch::async, [&] { return contents(pipe); });
  live.finish();
  EXPECT_EQ(live.health().state, node::HealthState::kOk) << live.health().reason;
  EXPECT_TRUE(std::filesystem::exists(dir.path() / "keyframes.lcmlog"));
}

// Killed while it polishes or draws its results, the process has lost nothing.
TEST_F(Slam2dNodeTest, SavesTheMapAtTheEndBeforeItsResultsAreWritten) {
  const nodmap::test::TemporaryDir dir;
  context_.out_dir = dir.path();
  put_odometry(0s, {});
  put_scan(0s, {});
  node_.finish();
  for (const char* name : {"map.pgm", "map.yaml", "keyframes.lcmlog"}) {
    EXPECT_TRUE(std::filesystem::exists(dir.path() / name)) << name;
  }
}

// The fraction of the occupied cells of a saved map that have none within a cell in another.
double misplaced_walls(const std::filesystem::path& map, const std::filesystem::path& other) {
  const TrinaryGrid walls = read_ros_map(map);
  const TrinaryGrid others = read_ros_map(other);
  const Eigen::Vector2d shift =
      (walls.T_map_grid.translation() - others.T_map_grid.translation()) / walls.cell_size_m;
  int all = 0;
  int misplaced = 0;
  for (int y = 0; y < walls.height; ++y) {
    for (int x = 0; x < walls.width; ++x) {
      if (walls.at(x, y) != CellState::kOccupied) {
        continue;
      }
      bool has_neighbour = false;
      for (int i = 0; i < 9; ++i) {
        has_neighbour |= others.at(x + static_cast<int>(std::lround(shift.x())) + i % 3 - 1,
                                   y + static_cast<int>(std::lround(shift.y())) + i / 3 - 1) ==
                         CellState::kOccupied;
      }
      ++all;
      misplaced += has_neighbour ? 0 : 1;
    }
  }
  return static_cast<double>(misplaced) / std::max(1, all);
}

// Drives around a ring corridor with a laser that sees 6 m: along the corridor the pose follows
// odometry, which is 6 % too long on the first side only. A loop corrects the pose in a jump, and
// moves what was drawn on the way.
TEST_F(Slam2dNodeTest, SavesTheWallsWhereALoopHasMovedThem) {
  geometry::SE2 truth;
  geometry::SE2 odom;
  std::int64_t i = 0;
  bool has_jumped = false;
  const auto error_m = [&truth](const nodmap::pose_t& pose) {
    return std::hypot(pose.position_m[0] - truth.x, pose.position_m[1] - truth.y);
  };
  const auto drive = [&](const geometry::SE2& step, double stretch) {
    const double error_before_m = i == 0 ? 0.0 : error_m(bus_.last<nodmap::pose_t>("POSE_2D"));
    truth = truth * step;
    odom = odom * geometry::SE2{stretch * step.x, 0.0, step.yaw};
    put_odometry(200ms * i, odom);
    scan::Scan scan = scanner_.scan(test::ring_corridor(), truth, time::Timestamp(200ms * i));
    scan.seq = i++;
    for (float& range_m : scan.ranges_m) {
      range_m = range_m > 6.0F ? std::numeric_limits<float>::infinity() : range_m;
    }
    bus_.deliver("SCAN", node::write_scan(scan));
    has_jumped = error_before_m - error_m(bus_.last<nodmap::pose_t>("POSE_2D")) > 0.3;
  };
  for (int side = 0; side < 8; ++side) {
    for (int k = 0; k < (side % 2 == 0 ? 70 : 50) && !has_jumped; ++k) {
      drive({0.2, 0.0, 0.0}, side == 0 ? 1.06 : 1.0);
    }
    for (int k = 0; k < 10 && !has_jumped; ++k) {
      drive({0.0, 0.0, geometry::deg_to_rad(9.0)}, 1.0);
    }
  }
  ASSERT_TRUE(has_jumped);
  const nodmap::test::TemporaryDir saved;
  context_.out_dir = saved.path();
  bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  // The saved keyframes, all drawn where they are now.
  const nodmap::test::TemporaryDir anew;
  Slam2dNode(context_, Slam2dParams{}, {{}, saved.path(), std::nullopt}).write_results(anew.path());
  // Less than half a cell of motion is not redrawn; it may round to the next cell but one.
  EXPECT_LT(misplaced_walls(saved.path(), anew.path()), 0.005);
  EXPECT_LT(misplaced_walls(anew.path(), saved.path()), 0.005);
}

TEST_F(Slam2dNodeTest, AMapLargerThanTheGridIsReported) {
  for (std::int64_t i = 0; i < 3; ++i) {
    const geometry::SE2 truth{0.4 * static_cast<double>(i), 0.0, 0.0};
    put_odometry(1s * i, truth);
    put_scan(1s * i, truth);
  }
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
  EXPECT_EQ(node_.metrics()["rays_beyond_grid"], 0);
  const nodmap::test::TemporaryDir dir;
  node_.write_results(dir.path());
  SavedMap saved = read_saved_map(dir.path());
  ASSERT_GT(saved.keyframes.size(), 1U);
  saved.keyframes.back().T_map_base = {500.0, 500.0, 0.0};
  ASSERT_FALSE(write_saved_map(dir.path(), saved));
  const Slam2dNode next{context_, Slam2dParams{}, {{}, dir.path(), std::nullopt}};
  EXPECT_EQ(next.health().state, node::HealthState::kDegraded);
  EXPECT_GT(next.metrics()["rays_beyond_grid"], 100);
}

}  // namespace node_saving_test
}  // namespace nodmap::slam2d
