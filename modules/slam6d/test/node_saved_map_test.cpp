// SPDX-License-Identifier: BSD-3-Clause
// When the node saves its map, and how it continues a saved one.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <future>
#include <optional>
#include <random>
#include <set>
#include <string>

#include "common/bus/codec.hpp"
#include "common/bus/replay_bus.hpp"
#include "common/formats/atomic_file.hpp"
#include "common/formats/tum.hpp"
#include "common/node/messages.hpp"
#include "modules/slam6d/back_end/saved_map_file.hpp"
#include "modules/slam6d/node.hpp"
#include "modules/slam6d/test/node_replay.hpp"
#include "modules/slam6d/test/room.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/pose_graph_6d_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::slam6d {
namespace node_test {

// A drive of 4 m is mapped and saved. Then the robot repeats it, with odometry that begins at
// another pose.
class Slam6dNodeInASavedMap : public ::testing::Test {
 protected:
  Slam6dNodeInASavedMap() {
    LogFile first(dir_.path() / "first.lcmlog");
    first.add_drive(true);
    first.close();
    first_ = replay(dir_.path(), "first", params_);
    geometry::SE3 T_odom_world = geometry::SE3::Identity();
    T_odom_world.translation() = Eigen::Vector3d(3.0, -7.0, 0.0);
    T_odom_world.linear() = geometry::rotation_of({0.0, 0.0, 2.0});
    LogFile second(dir_.path() / "second.lcmlog");
    second.add_drive(true, 0, T_odom_world);
    second.close();
  }

  // With 1 cm of scan noise each drive is registered to better than 2 cm, so that both together
  // differ by less than 4 cm along the drive.
  static void expect_at_truth(const Outcome& outcome) {
    ASSERT_EQ(outcome.published.at("POSE_6D").size(), 4U);
    for (const auto& bytes : outcome.published.at("POSE_6D")) {
      nodmap::pose_t pose{};
      ASSERT_TRUE(bus::decode_into(pose, bytes));
      EXPECT_EQ(pose.state, nodmap::pose_t::TRACKING);
      EXPECT_NEAR(pose.position_m[0], 1e-6 * static_cast<double>(pose.utime), 0.04);
      EXPECT_NEAR(pose.position_m[1], 0.0, 0.02);
    }
  }

  test::TemporaryDir dir_;
  Slam6dParams params_{.keyframe = {.distance_m = 1.0}};
  Outcome first_;
  fs::path saved_ = dir_.path() / "out_first";
};

TEST_F(Slam6dNodeInASavedMap, LocalisesAndLeavesTheMapUnchanged) {
  const std::string before = read(saved_ / "keyframes.lcmlog");
  const Outcome second = replay(dir_.path(), "second", params_,
                                node::MapOptions{saved_, {}, geometry::SE2{0.0, 0.0, 0.0}});
  expect_at_truth(second);
  EXPECT_EQ(second.metrics["localisation"]["keyframes_restored"],
            first_.metrics["keyframes"].size());
  EXPECT_TRUE(second.metrics["keyframes"].empty());
  EXPECT_EQ(second.published.count("OCTOMAP"), 0U);
  EXPECT_FALSE(fs::exists(dir_.path() / "out_second" / "keyframes.lcmlog"));
  EXPECT_FALSE(fs::exists(dir_.path() / "out_second" / "map.bt"));
  EXPECT_EQ(formats::read_tum(dir_.path() / "out_second" / "trajectory.tum").size(), 4U);
  EXPECT_TRUE(read(saved_ / "keyframes.lcmlog") == before);
  // The saved keyframes are published, so that the page can show the cloud.
  std::set<std::int64_t> ids;
  for (const auto& bytes : second.published.at("CLOUD")) {
    nodmap::cloud_chunk_t part{};
    ASSERT_TRUE(bus::decode_into(part, bytes));
    ids.insert(part.keyframe_id);
  }
  EXPECT_EQ(ids.size(), first_.metrics["keyframes"].size());
}

TEST_F(Slam6dNodeInASavedMap, ContinuesTheMap) {
  const Outcome second = replay(dir_.path(), "second", params_,
                                node::MapOptions{{}, saved_, geometry::SE2{0.0, 0.0, 0.0}});
  expect_at_truth(second);
  const std::size_t num_before = first_.metrics["keyframes"].size();
  ASSERT_GE(second.metrics["keyframes"].size(), 1U) << "3 m from the start pose";
  EXPECT_EQ(second.metrics["keyframes"][0]["reason"], "interruption");
  const SavedMap before = read_saved_map(saved_);
  const SavedMap after = read_saved_map(dir_.path() / "out_second");
  ASSERT_EQ(after.keyframes.size(), num_before + second.metrics["keyframes"].size());
  for (std::size_t k = 0; k < num_before; ++k) {
    EXPECT_EQ(after.keyframes[k].cloud->points, before.keyframes[k].cloud->points);
  }
  // The adjustment at the end of the first drive is not undone by the next optimisation.
  for (const registration::PoseEdge3d& step : before.steps) {
    const geometry::SE3 T_from_to =
        before.keyframes[step.from].T_map_base.inverse() * before.keyframes[step.to].T_map_base;
    EXPECT_LT(geometry::distance_m(step.T_from_to, T_from_to), 1e-9) << step.to;
  }
  // The new drive is joined to the old one where its place is confirmed: at the end of the old one.
  EXPECT_EQ(after.steps[num_before - 1].from, num_before - 1);
  nodmap::pose_graph_6d_t graph{};
  ASSERT_TRUE(bus::decode_into(graph, second.published.at("POSE_GRAPH_6D").back()));
  EXPECT_EQ(static_cast<std::size_t>(graph.num_keyframes), after.keyframes.size());
  EXPECT_EQ(graph.first_keyframe_id, 0);
}

// The process is killed as soon as a map is on the disk, whatever it is writing at that time.
TEST_F(Slam6dNodeInASavedMap, AfterAKillTheLastCompleteMapCanBeContinued) {
  const fs::path killed = dir_.path() / "killed";
  fs::create_directories(killed);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    params_.occupancy.save_every_keyframes = 1;
    node::MessageCounts counts;
    bus::ReplayBus bus(dir_.path() / "first.lcmlog", killed / "out.lcmlog");
    node::Context context{bus, counts, killed};
    const Slam6dNode slam(context, params_);
    while (bus.step()) {
      if (fs::exists(killed / "keyframes.lcmlog")) {
        ::kill(::getpid(), SIGKILL);
      }
    }
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "nothing was saved on the way";
  const std::size_t num_saved = read_saved_map(killed).keyframes.size();
  EXPECT_GT(num_saved, 0U);
  const Outcome second = replay(dir_.path(), "second", params_,
                                node::MapOptions{{}, killed, geometry::SE2{0.0, 0.0, 0.0}});
  expect_at_truth(second);
  EXPECT_EQ(second.metrics["localisation"]["keyframes_restored"], num_saved);
}

TEST_F(Slam6dNodeInASavedMap, ARobotThatIsNotFoundLeavesTheMapUnchanged) {
  params_.localise.place.min_inlier_ratio = 1.0;  // no place is good enough
  const Outcome second = replay(dir_.path(), "second", params_, node::MapOptions{{}, saved_, {}});
  EXPECT_EQ(second.metrics["sweeps_lost"], 4);
  EXPECT_TRUE(second.metrics["keyframes"].empty());
  EXPECT_EQ(second.health.state, node::HealthState::kDegraded);
  EXPECT_TRUE(formats::read_tum(dir_.path() / "out_second" / "trajectory.tum").empty());
  nodmap::pose_t pose{};
  ASSERT_TRUE(bus::decode_into(pose, second.published.at("POSE_6D").back()));
  EXPECT_EQ(pose.state, nodmap::pose_t::LOST);
  EXPECT_EQ(read_saved_map(dir_.path() / "out_second").keyframes.size(),
            first_.metrics["keyframes"].size());
}

// In another room than the map's, with sweeps of 40 scans: one is registered all the time.
TEST_F(Slam6dNodeInASavedMap, TriesAgainToSaveWhileTheRobotHasNotBeenFound) {
  test::MemoryBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, dir_.path() / "not_there_yet"};
  params_.assume_stationary = true;
  Slam6dNode slam(context, params_, node::MapOptions{{}, saved_, {}});
  const NoddingScanner scanner{.step_rad = geometry::deg_to_rad(2.0)};
  const Room elsewhere{
      {{{0, 0, 1}, 0.0}, {{0, 0, 1}, 9.0}, {{1, 1, 0}, 20.0}, {{1, -1, 0}, -15.0}}};
  std::mt19937 random(9);
  std::int64_t next = 0;
  const auto put_scans = [&](int number) {
    for (int i = 0; i < number; ++i) {
      const auto still = [](time::Timestamp) { return geometry::SE3::Identity(); };
      bus.deliver("SCAN", node::write_scan(scanner.scan(next++, elsewhere, still, random)));
    }
  };
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  put_scans(75);  // one second: the first attempt is over
  ASSERT_EQ(slam.health().state, node::HealthState::kDegraded);
  fs::create_directory(context.out_dir);
  put_scans(825);  // 11 s
  EXPECT_EQ(slam.metrics()["localisation"]["searches_found"], 0);
  EXPECT_TRUE(fs::exists(context.out_dir / "map.bt"));
}

TEST(Slam6dNode, SavesOnRequestAndEveryFewKeyframes) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "save.lcmlog");
  log.add_drive(true);
  nodmap::save_request_t request{};
  request.requested_by = "test";
  log.add(time::Timestamp(6s), "SAVE_REQUEST", request);
  log.close();
  const Outcome outcome =
      replay(dir.path(), "save",
             {.keyframe = {.distance_m = 2.0}, .occupancy = {.save_every_keyframes = 1}});
  // Saved five times: after each of the two keyframes, on request, before the map is polished, and
  // at the end.
  EXPECT_EQ(outcome.metrics["occupancy_map"]["times_saved"], 5);
}

TEST(Slam6dNode, TriesAgainToSaveAMapThatCouldNotBeSaved) {
  const test::TemporaryDir dir;
  test::MemoryBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, dir.path() / "not_there_yet"};
  Slam6dNode slam(context, {.assume_stationary = true});
  std::mt19937 random(9);
  std::int64_t next = 0;
  const auto put_scans = [&](int number) {
    for (int i = 0; i < number; ++i) {
      const auto still = [](time::Timestamp) { return geometry::SE3::Identity(); };
      bus.deliver("SCAN",
                  node::write_scan(NoddingScanner{}.scan(next++, Room::hall(), still, random)));
    }
  };
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  put_scans(75);  // one second: the first attempt is over
  EXPECT_EQ(slam.health().state, node::HealthState::kDegraded);
  fs::create_directory(context.out_dir);
  put_scans(600);
  EXPECT_FALSE(fs::exists(context.out_dir / "map.bt")) << "not at once";
  put_scans(225);  // 12 s after the request
  EXPECT_TRUE(fs::exists(context.out_dir / "map.bt"));
  EXPECT_EQ(slam.health().state, node::HealthState::kOk) << slam.health().reason;
}

// The disk is a pipe that nobody reads, so that saving does not end before the scans have.
TEST(Slam6dNode, LiveNoScanWaitsUntilTheMapIsSaved) {
  const test::TemporaryDir dir;
  const fs::path pipe = formats::unfinished_name(dir.path() / "map.bt");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  test::MemoryBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, dir.path(), node::ResultsUsed::kWhenReady};
  Slam6dNode slam(context, {.assume_stationary = true});
  std::mt19937 random(9);
  const auto still = [](time::Timestamp) { return geometry::SE3::Identity(); };
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  for (std::int64_t i = 0; i < 320; ++i) {  // four sweeps
    bus.deliver("SCAN", node::write_scan(NoddingScanner{}.scan(i, Room::hall(), still, random)));
  }
  EXPECT_EQ(slam.health().state, node::HealthState::kOk) << slam.health().reason;
  const auto drained = std::async(std::launch::async, [&] { return read(pipe); });
  slam.finish();
  EXPECT_EQ(bus.count("POSE_6D"), 4U);
  EXPECT_EQ(counts.used(), 321);
  EXPECT_TRUE(fs::is_regular_file(dir.path() / "map.bt"));
}

// A process that takes too long to stop is killed while it polishes its map.
TEST(Slam6dNode, IsSavedBeforeItIsPolished) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "drive.lcmlog");
  log.add_drive(true);
  log.close();
  bus::ReplayBus bus(dir.path() / "drive.lcmlog", dir.path() / "out.lcmlog");
  node::MessageCounts counts;
  node::Context context{bus, counts, dir.path()};
  Slam6dNode slam(context, {.keyframe = {.distance_m = 2.0}});
  while (bus.step()) {
  }
  slam.finish();
  const SavedMap before = read_saved_map(dir.path());
  EXPECT_TRUE(fs::exists(dir.path() / "map.bt"));
  slam.write_results(dir.path());
  const SavedMap after = read_saved_map(dir.path());
  ASSERT_EQ(before.keyframes.size(), 2U);
  ASSERT_EQ(after.keyframes.size(), 2U);
  EXPECT_GT(geometry::distance_m(before.keyframes[1].T_map_base, after.keyframes[1].T_map_base),
            0.0)
      << "the first file is that of the polished map";
}

TEST(Slam6dNode, AfterAFailedSaveARequestIsCarriedOutAtOnce) {
  const test::TemporaryDir dir;
  test::MemoryBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, dir.path() / "not_there_yet"};
  const Slam6dNode slam(context, {.assume_stationary = true});
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  // Each request first waits for the outcome of the attempt before, and this one begins another.
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  EXPECT_EQ(slam.health().state, node::HealthState::kDegraded);
  fs::create_directory(context.out_dir);
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  EXPECT_TRUE(fs::exists(context.out_dir / "map.bt"));
  EXPECT_EQ(slam.health().state, node::HealthState::kOk) << slam.health().reason;
}

TEST(Slam6dNode, SavesAtMostOnceEveryTenSeconds) {
  const test::TemporaryDir dir;
  test::MemoryBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, dir.path()};
  const Slam6dNode slam(context, {.assume_stationary = true});
  const NoddingScanner scanner;
  std::mt19937 random(9);
  const auto still = [](time::Timestamp) { return geometry::SE3::Identity(); };
  for (std::int64_t decis = 0; decis < 200; ++decis) {
    scan::Scan scan = scanner.scan(decis, Room::hall(), still, random);
    scan.stamp = time::Timestamp(100ms * decis);
    bus.deliver("SCAN", node::write_scan(scan));
    bus.deliver("SAVE_REQUEST", nodmap::save_request_t{});
  }
  EXPECT_EQ(counts.rejected().at("save_request_too_soon"), 198);
  EXPECT_TRUE(fs::exists(dir.path() / "map.bt"));
}

TEST(Slam6dNode, AResultThatCannotBeWrittenCostsNoOther) {
  const test::TemporaryDir dir;
  test::MemoryBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, dir.path()};
  Slam6dNode slam(context, {.assume_stationary = true});
  std::mt19937 random(9);
  const auto still = [](time::Timestamp) { return geometry::SE3::Identity(); };
  for (std::int64_t i = 0; i < 160; ++i) {  // two sweeps
    bus.deliver("SCAN", node::write_scan(NoddingScanner{}.scan(i, Room::hall(), still, random)));
  }
  slam.finish();
  fs::create_directory(dir.path() / "trajectory.tum");
  EXPECT_THROW(slam.write_results(dir.path()), std::runtime_error);
  for (const char* name : {"map.bt", "keyframes.lcmlog", "cloud.ply"}) {
    EXPECT_TRUE(fs::exists(dir.path() / name)) << name;
  }
}

}  // namespace node_test
}  // namespace nodmap::slam6d
