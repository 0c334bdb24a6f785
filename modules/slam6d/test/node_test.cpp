// SPDX-License-Identifier: BSD-3-Clause
// What the node publishes, and what it writes at the end.
#include "modules/slam6d/node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/formats/ply.hpp"
#include "common/formats/tum.hpp"
#include "common/node/messages.hpp"
#include "modules/slam6d/test/mounted_scan.hpp"
#include "modules/slam6d/test/node_replay.hpp"
#include "modules/slam6d/test/room.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/octomap_chunk_t.hpp"
#include "nodmap/pose_graph_6d_t.hpp"
#include "nodmap/pose_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::slam6d {
namespace node_test {

TEST(Slam6dNode, ReplayWritesTheSameFilesEachTime) {
  const test::TemporaryDir dir;
  for (const char* name : {"a", "b"}) {
    LogFile log(dir.path() / (std::string(name) + ".lcmlog"));
    log.add_drive(true);
    log.close();
  }
  const Outcome outcome =
      replay(dir.path(), "a", {.keyframe = {.distance_m = 2.0}, .occupancy = {.save_ot = true}});
  EXPECT_EQ(outcome.counts.used(), 640);
  EXPECT_EQ(outcome.counts.total_rejected(), 0);
  EXPECT_EQ(outcome.metrics["sweeps"], 4);
  EXPECT_EQ(outcome.metrics["keyframes"].size(), 2U);
  EXPECT_EQ(outcome.metrics["keyframes"][1]["reason"], "distance");
  EXPECT_EQ(outcome.health.state, node::HealthState::kOk);

  const fs::path out = dir.path() / "out_a";
  EXPECT_EQ(formats::read_tum(out / "trajectory.tum").size(), 4U);
  EXPECT_EQ(formats::read_tum(out / "online.tum").size(), 4U);
  EXPECT_EQ(formats::read_ply(out / "cloud.ply").size(),
            outcome.metrics["keyframes"][0]["points"].get<std::size_t>() +
                outcome.metrics["keyframes"][1]["points"].get<std::size_t>());
  replay(dir.path(), "b", {.keyframe = {.distance_m = 2.0}, .occupancy = {.save_ot = true}});
  for (const char* file : {"trajectory.tum", "online.tum", "cloud.ply", "map.bt", "map.ot",
                           "map.png", "path.png", "out.lcmlog"}) {
    EXPECT_TRUE(fs::file_size(out / file) > 0) << file;
    EXPECT_TRUE(read(out / file) == read(dir.path() / "out_b" / file)) << file;
  }
}

TEST(Slam6dNode, PublishesAPosePerSweepAndACloudPerKeyframe) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "drive.lcmlog");
  log.add_drive(true);
  log.close();
  Outcome outcome = replay(dir.path(), "drive", {.keyframe = {.distance_m = 2.0}});
  ASSERT_EQ(outcome.published["POSE_6D"].size(), 4U);
  nodmap::pose_t pose{};
  ASSERT_TRUE(bus::decode_into(pose, outcome.published["POSE_6D"][0]));
  EXPECT_EQ(pose.state, nodmap::pose_t::TRACKING);
  ASSERT_TRUE(bus::decode_into(pose, outcome.published["POSE_6D"][1]));
  EXPECT_EQ(pose.state, nodmap::pose_t::TRACKING);
  EXPECT_LT(pose.utime, 1'000'000'000);  // in the log's time, which begins at 0
  // The hall is 2 m wide and 2.5 m high, and the scan noise is 1 cm. Across the hall some 1000
  // points on planes, of which ten count as one, determine the pose to millimetres. Along it the
  // end walls determine the pose.
  for (int i = 0; i < 6; ++i) {
    EXPECT_GT(pose.covariance[i][i], 0.0) << i;
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(pose.covariance[i][j], pose.covariance[j][i], 1e-12);
    }
  }
  EXPECT_LT(std::sqrt(pose.covariance[1][1]), 0.005);
  EXPECT_LT(std::sqrt(pose.covariance[0][0]), 0.02);

  std::size_t num_points = 0;
  std::size_t num_first_parts = 0;
  for (const auto& bytes : outcome.published["CLOUD"]) {
    EXPECT_LT(bytes.size(), 65536U);
    nodmap::cloud_chunk_t part{};
    ASSERT_TRUE(bus::decode_into(part, bytes));
    EXPECT_LT(part.chunk_index, part.num_chunks);
    num_first_parts += part.chunk_index == 0 ? 1U : 0U;
    num_points += static_cast<std::size_t>(part.num_points);
  }
  EXPECT_EQ(num_first_parts, 2U);
  EXPECT_GT(num_points, 1000U);
}

// The parts of each revision make up a file. The last revision is the file that is saved at the
// end.
TEST(Slam6dNode, PublishesTheOctomapThatItSaves) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "drive.lcmlog");
  log.add_drive(true);
  log.close();
  Outcome outcome = replay(dir.path(), "drive", {.occupancy = {.publish_period_s = 1000.0}});
  std::map<std::int64_t, std::string> maps;
  for (const auto& bytes : outcome.published["OCTOMAP"]) {
    EXPECT_LT(bytes.size(), 65536U);
    nodmap::octomap_chunk_t part{};
    ASSERT_TRUE(bus::decode_into(part, bytes));
    maps[part.map_revision].append(part.bytes.begin(), part.bytes.end());
  }
  // The map of the first keyframe is published at once; the second comes within the period, and
  // waits for the end.
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_NE(maps[0], maps[1]);
  EXPECT_TRUE(maps[1] == read(dir.path() / "out_drive" / "map.bt"));
}

TEST(Slam6dNode, WithAPublishPeriodOfZeroNoOctomapIsPublished) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "drive.lcmlog");
  log.add_drive(true);
  log.close();
  EXPECT_FALSE(replay(dir.path(), "drive", {.occupancy = {.publish_period_s = 0.0}})
                   .published.contains("OCTOMAP"));
}

TEST(Slam6dNode, ContinuesAtItsPoseWhenOdometryRestarts) {
  const test::TemporaryDir dir;
  constexpr std::int64_t kRestart = 200;  // in the middle of the third sweep, 2.7 m along
  LogFile log(dir.path() / "restart.lcmlog");
  log.add_drive(true, kRestart);
  log.close();
  Outcome outcome = replay(dir.path(), "restart", {});
  // The current sweep is cut at the restart: there are five sweeps instead of four. Only the first
  // ODOMETRY after the restart is not used, which the next one confirms.
  ASSERT_EQ(outcome.published["POSE_6D"].size(), 5U);
  EXPECT_EQ(outcome.counts.used(), 639);
  EXPECT_EQ(outcome.metrics["keyframes"].back()["reason"], "interruption");
  for (std::size_t i = 0; i < 5; ++i) {
    nodmap::pose_t pose{};
    ASSERT_TRUE(bus::decode_into(pose, outcome.published["POSE_6D"][i]));
    const double truth_m = 1e-6 * static_cast<double>(pose.utime);
    // The motion during one scan, 1.3 cm at 1 m/s, is lost at the restart; registration in a hall
    // with 1 cm of scan noise is better than 2 cm.
    EXPECT_NEAR(pose.position_m[0], truth_m, 0.033) << i;
    // The published correction refers to the odometry frame of its time: to the new one after the
    // restart.
    const double start_m =
        node::stamp_of(pose) < time::Timestamp(kRestart * NoddingScanner::kPeriod)
            ? 0.0
            : time::seconds(kRestart * NoddingScanner::kPeriod);
    EXPECT_NEAR(pose.odom_position_m[0], start_m, 0.033) << i;
  }
  // The same must hold for the trajectory with all corrections.
  for (const auto& pose : formats::read_tum(dir.path() / "out_restart" / "trajectory.tum")) {
    EXPECT_NEAR(pose.pose.translation().x(), time::seconds(pose.stamp.time_since_epoch()), 0.033);
  }
}

// A base that has counted on while 6D SLAM was restarted, or odometry in the coordinates of a
// country: the octree ends 1638 m from the origin.
TEST(Slam6dNode, ARobotOutsideOfTheOctreeIsReported) {
  const test::TemporaryDir dir;
  for (const double x_m : {1000.0, 2000.0, 500'000.0}) {
    const std::string name = std::to_string(static_cast<int>(x_m));
    LogFile log(dir.path() / (name + ".lcmlog"));
    geometry::SE3 T_odom_world = geometry::SE3::Identity();
    T_odom_world.translation().x() = x_m;
    log.add_drive(true, 0, T_odom_world);
    log.close();
    const Outcome outcome = replay(dir.path(), name, {});
    const bool is_inside = x_m < 1638.0;
    EXPECT_EQ(outcome.metrics["occupancy_map"]["nodes"] > 0, is_inside) << name;
    const bool is_mapped = x_m < 105e3;  // where the voxels end
    EXPECT_EQ(outcome.metrics["occupancy_map"]["beams_outside"] > 0, is_mapped && !is_inside);
    EXPECT_EQ(!outcome.metrics["keyframes"].empty(), is_mapped) << name;
    EXPECT_EQ(outcome.health.state == node::HealthState::kOk, is_inside) << name;
    if (!is_inside) {
      const std::string km = std::to_string(static_cast<int>(x_m / 1000.0)) + ".0 km";
      EXPECT_NE(outcome.health.reason.find(km), std::string::npos) << outcome.health.reason;
    }
  }
}

TEST(Slam6dNode, BadMessagesAreCountedByCause) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "bad.lcmlog");
  log.add_drive(true);
  nodmap::scan_t scan{};  // no field is filled in
  log.add(time::Timestamp(5s), "SCAN", scan);
  std::mt19937 random(10);
  scan = node::write_scan(NoddingScanner{}.scan(
      320, Room::hall(), [](time::Timestamp) { return geometry::SE3::Identity(); }, random));
  scan.utime = -1;
  log.add(time::Timestamp(5s), "SCAN", scan);
  scan.utime = std::numeric_limits<std::int64_t>::max();
  log.add(time::Timestamp(5s), "SCAN", scan);
  log.add(time::Timestamp(5s), "ODOMETRY", nodmap::odometry_t{});
  log.close();
  const Outcome outcome = replay(dir.path(), "bad", {});
  EXPECT_EQ(outcome.counts.rejected().at("implausible_scan"), 3);
  EXPECT_EQ(outcome.counts.rejected().at("implausible_odometry"), 1);
  EXPECT_EQ(outcome.counts.used(), 640);
}

TEST(Slam6dNode, WithoutOdometryScansAreRejectedUnlessStationaryIsAssumed) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "still.lcmlog");
  log.add_drive(false);
  log.close();
  const Outcome rejected = replay(dir.path(), "still", {});
  EXPECT_EQ(rejected.counts.rejected().at("scan_without_odometry"), 320);
  EXPECT_EQ(rejected.health.state, node::HealthState::kDegraded);
  fs::remove_all(dir.path() / "out_still");
  const Outcome stationary = replay(dir.path(), "still", {.assume_stationary = true});
  EXPECT_EQ(stationary.counts.used(), 320);
  EXPECT_EQ(stationary.metrics["keyframes"].size(), 1U);
}

// A base that sends 7 messages a second, the last one with the last scan.
TEST(Slam6dNode, SlowOdometrySuffices) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "slow.lcmlog");
  log.add_drive(true, 0, geometry::SE3::Identity(), 11);
  log.close();
  const Outcome outcome = replay(dir.path(), "slow", {});
  EXPECT_EQ(outcome.metrics["sweeps"], 4);
  EXPECT_EQ(outcome.metrics["sweeps_tracked"], 3);  // the first one is the map
  EXPECT_TRUE(outcome.counts.rejected().empty());
  EXPECT_EQ(outcome.health.state, node::HealthState::kOk);
}

TEST(Slam6dNode, OdometryThatStopsIsReported) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "stops.lcmlog");
  log.add_drive(true, 0, geometry::SE3::Identity(), 1, 200);
  log.close();
  const Outcome outcome = replay(dir.path(), "stops", {});
  EXPECT_NEAR(static_cast<double>(outcome.counts.rejected().at("scan_without_odometry")), 120.0,
              4.0);  // all but those within 50 ms
  EXPECT_EQ(outcome.health.state, node::HealthState::kDegraded);
}

// A laser that looks half a degree too high. When that is certain the map begins again: receivers
// get all clouds again, the graph and the OctoMap are new, and a replay gives the same bytes.
TEST(Slam6dNode, AMapThatBeginsAgainIsPublishedAgain) {
  constexpr MountError kMount{.pitch_rad = geometry::deg_to_rad(0.5)};
  constexpr std::int64_t kSweeps = 14;
  const test::TemporaryDir dir;
  Room room = Room::corridor();
  room.walls.push_back({Eigen::Vector3d(1.0, 0.3, 0.0).normalized(), 10.0});
  room.walls.push_back({{1, 0, 0}, -4.0});
  const auto motion = [](time::Timestamp t) { return drive_ahead(0.5, t); };
  for (const char* name : {"a", "b"}) {
    std::mt19937 random(9);
    LogFile log(dir.path() / (std::string(name) + ".lcmlog"));
    for (std::int64_t i = 0; i < kSweeps * kScansOfSweep; ++i) {
      const time::Timestamp stamp(i * NoddingScanner::kPeriod);
      auto odometry = node::write_odometry(stamp, motion(stamp));
      odometry.odometry_seq = i;
      log.add(stamp, "ODOMETRY", odometry);
      log.add(stamp, "SCAN", node::write_scan(mounted_scan(kMount, i, room, motion, random)));
    }
    log.close();
  }
  const Outcome outcome = replay(dir.path(), "a", {});
  // 0.02 degrees for each of 9 floors; three times that.
  EXPECT_NEAR(outcome.metrics["mount_errors"]["corrected"]["pitch_deg"].get<double>(), 0.5, 0.06);
  EXPECT_EQ(outcome.metrics["mount_errors"]["corrected"]["roll_deg"], 0.0);
  EXPECT_EQ(outcome.published.at("POSE_6D").size(), static_cast<std::size_t>(kSweeps));

  nodmap::pose_graph_6d_t graph{};
  ASSERT_TRUE(bus::decode_into(graph, outcome.published.at("POSE_GRAPH_6D").back()));
  std::map<std::int64_t, std::vector<std::int64_t>> utimes;  // of each keyframe's clouds
  for (const auto& bytes : outcome.published.at("CLOUD")) {
    nodmap::cloud_chunk_t chunk{};
    ASSERT_TRUE(bus::decode_into(chunk, bytes));
    if (chunk.chunk_index == 0) {
      utimes[chunk.keyframe_id].push_back(chunk.utime);
    }
  }
  ASSERT_GE(graph.num_keyframes, 4);
  for (std::size_t k = 0; k < graph.keyframe_utime.size(); ++k) {
    EXPECT_EQ(utimes[static_cast<std::int64_t>(k)].back(), graph.keyframe_utime[k]);
  }
  EXPECT_GE(utimes[0].size(), 2U) << "before and after";
  EXPECT_EQ(utimes.rbegin()->second.size(), 1U) << "the newest is later";

  replay(dir.path(), "b", {});
  const fs::path out = dir.path() / "out_a";
  for (const char* file : {"trajectory.tum", "online.tum", "cloud.ply", "map.bt", "out.lcmlog"}) {
    EXPECT_TRUE(read(out / file) == read(dir.path() / "out_b" / file)) << file;
  }
}

}  // namespace node_test
}  // namespace nodmap::slam6d
