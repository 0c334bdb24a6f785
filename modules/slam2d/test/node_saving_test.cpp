// SPDX-License-Identifier: BSD-3-Clause
// What 2D SLAM's process saves on request, and what it does when it cannot.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/node/messages.hpp"
#include "modules/slam2d/map_file.hpp"
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

}  // namespace node_saving_test
}  // namespace nodmap::slam2d
