// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/node.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/bus/replay_bus.hpp"
#include "common/formats/ply.hpp"
#include "common/formats/tum.hpp"
#include "common/node/messages.hpp"
#include "modules/slam6d/saved_map_file.hpp"
#include "modules/slam6d/test/room.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/octomap_chunk_t.hpp"
#include "nodmap/pose_graph_6d_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::slam6d {
namespace node_test {

namespace fs = std::filesystem;

class LogFile {
 public:
  explicit LogFile(const fs::path& file) : writer_(file) {}

  template <class Message>
  void add(time::Timestamp stamp, const std::string& channel, const Message& message) {
    std::vector<std::byte> bytes;
    bus::encode_into(bytes, message);
    ASSERT_TRUE(writer_.write(time::to_utime(stamp), channel, bytes));
  }

  // 320 scans (4 sweeps) of a drive through a hall at 1 m/s: 4.3 m, so that with keyframes 2 m
  // apart two sweeps are registered.
  // From scan `restart` on odometry counts and measures from zero again, as after a restart of the
  // base driver.
  // `T_odom_world`: where odometry begins.
  void add_drive(bool with_odometry, std::int64_t restart = 0,
                 const geometry::SE3& T_odom_world = geometry::SE3::Identity()) {
    std::mt19937 random(9);
    const NoddingScanner scanner{.noise_m = 0.01};
    const auto motion = [](time::Timestamp t) { return drive_ahead(1.0, t); };
    for (std::int64_t i = 0; i < 320; ++i) {
      const time::Timestamp stamp(i * NoddingScanner::kPeriod);
      if (with_odometry) {
        const std::int64_t first = i < restart ? 0 : restart;
        const geometry::SE3 T_start_odom = motion(time::Timestamp(first * NoddingScanner::kPeriod));
        auto odometry =
            node::write_odometry(stamp, T_odom_world * T_start_odom.inverse() * motion(stamp));
        odometry.odometry_seq = i - first;
        add(stamp, "ODOMETRY", odometry);
      }
      add(stamp, "SCAN", node::write_scan(scanner.scan(i, Room::hall(), motion, random)));
    }
  }

  void close() { ASSERT_TRUE(writer_.flush()); }

 private:
  bus::LogWriter writer_;
};

// What a node made of a log.
struct Outcome {
  node::MessageCounts counts;
  nlohmann::json metrics;
  node::Health health;
  std::map<std::string, std::vector<std::vector<std::byte>>> published;
};

Outcome replay(const fs::path& dir, const std::string& name, const Slam6dParams& params,
               const std::optional<node::MapOptions>& map = std::nullopt) {
  Outcome outcome;
  const fs::path out = dir / ("out_" + name);
  fs::create_directories(out);
  {
    bus::ReplayBus bus(dir / (name + ".lcmlog"), out / "out.lcmlog");
    node::Context context{bus, outcome.counts, out};
    const auto slam = map ? std::make_unique<Slam6dNode>(context, params, *map)
                          : std::make_unique<Slam6dNode>(context, params);
    while (bus.step()) {
    }
    slam->finish();
    slam->write_results(out);
    outcome.metrics = slam->metrics();
    outcome.health = slam->health();
    EXPECT_TRUE(bus.flush());
  }
  bus::LogReader reader(out / "out.lcmlog");
  while (const bus::LogEvent* event = reader.next()) {
    outcome.published[event->channel].emplace_back(event->data.begin(), event->data.end());
  }
  return outcome;
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Slam6dNode, ReplayWritesEverythingTheSameEachTime) {
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
  EXPECT_EQ(pose.utime % 1'000'000'000, pose.utime);
  // Across a hall of 2 m x 2.5 m that is seen with noise of 1 cm the pose is known to millimetres
  // (planes: some 1000 points, of which ten count as one), along it to what its end walls tell.
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

// The parts of a revision are a file: the last one the file that is saved at the end.
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
  // The first keyframe's at once; the second, within the period, waits for the end.
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_NE(maps[0], maps[1]);
  EXPECT_TRUE(maps[1] == read(dir.path() / "out_drive" / "map.bt"));
}

TEST(Slam6dNode, PublishesNoOctomapWhenNoneIsWanted) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "drive.lcmlog");
  log.add_drive(true);
  log.close();
  EXPECT_FALSE(replay(dir.path(), "drive", {.occupancy = {.publish_period_s = 0.0}})
                   .published.contains("OCTOMAP"));
}

TEST(Slam6dNode, GoesOnWhereItWasWhenOdometryBeginsAnew) {
  const test::TemporaryDir dir;
  constexpr std::int64_t kRestart = 200;  // in the middle of the third sweep, 2.7 m along
  LogFile log(dir.path() / "restart.lcmlog");
  log.add_drive(true, kRestart);
  log.close();
  Outcome outcome = replay(dir.path(), "restart", {});
  // The running sweep is cut there: five instead of four, and no scan of them is lost.
  ASSERT_EQ(outcome.published["POSE_6D"].size(), 5U);
  EXPECT_EQ(outcome.counts.used(), 640);
  EXPECT_EQ(outcome.metrics["keyframes"].back()["reason"], "interruption");
  for (std::size_t i = 0; i < 5; ++i) {
    nodmap::pose_t pose{};
    ASSERT_TRUE(bus::decode_into(pose, outcome.published["POSE_6D"][i]));
    const double truth_m = 1e-6 * static_cast<double>(pose.utime);
    // The way of one scan at 1 m/s, 1.3 cm, is lost at the restart; registration in a hall with 1
    // cm of scan noise is better than 2 cm.
    EXPECT_NEAR(pose.position_m[0], truth_m, 0.033) << i;
    // The correction leads from the odometry of its time: from the new one after the restart.
    const double start_m =
        node::stamp_of(pose) < time::Timestamp(kRestart * NoddingScanner::kPeriod)
            ? 0.0
            : time::seconds(kRestart * NoddingScanner::kPeriod);
    EXPECT_NEAR(pose.odom_position_m[0], start_m, 0.033) << i;
  }
  // With all that is known, too.
  for (const auto& pose : formats::read_tum(dir.path() / "out_restart" / "trajectory.tum")) {
    EXPECT_NEAR(pose.pose.translation().x(), time::seconds(pose.stamp.time_since_epoch()), 0.033);
  }
}

// A drive of 4 m is mapped; then the robot begins it anew, with odometry somewhere else.
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

  // Both drives are registered to better than 2 cm (1 cm of scan noise).
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

TEST_F(Slam6dNodeInASavedMap, LocalisesAndLeavesItAsItIs) {
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
  // The saved keyframes, of which the page makes the cloud.
  std::set<std::int64_t> ids;
  for (const auto& bytes : second.published.at("CLOUD")) {
    nodmap::cloud_chunk_t part{};
    ASSERT_TRUE(bus::decode_into(part, bytes));
    ids.insert(part.keyframe_id);
  }
  EXPECT_EQ(ids.size(), first_.metrics["keyframes"].size());
}

TEST_F(Slam6dNodeInASavedMap, CarriesOnWithIt) {
  const Outcome second = replay(dir_.path(), "second", params_,
                                node::MapOptions{{}, saved_, geometry::SE2{0.0, 0.0, 0.0}});
  expect_at_truth(second);
  const std::size_t num_before = first_.metrics["keyframes"].size();
  EXPECT_GT(second.metrics["keyframes"].size(), 1U);
  EXPECT_EQ(second.metrics["keyframes"][0]["reason"], "interruption");
  const SavedMap before = read_saved_map(saved_);
  const SavedMap after = read_saved_map(dir_.path() / "out_second");
  ASSERT_EQ(after.keyframes.size(), num_before + second.metrics["keyframes"].size());
  for (std::size_t k = 0; k < num_before; ++k) {
    EXPECT_EQ(after.keyframes[k].cloud->points, before.keyframes[k].cloud->points);
  }
  // The new drive is joined to the old one where it begins.
  EXPECT_EQ(after.steps[num_before - 1].from, 0U);
  nodmap::pose_graph_6d_t graph{};
  ASSERT_TRUE(bus::decode_into(graph, second.published.at("POSE_GRAPH_6D").back()));
  EXPECT_EQ(static_cast<std::size_t>(graph.num_keyframes), after.keyframes.size());
  EXPECT_EQ(graph.first_keyframe_id, 0);
}

// Killed as soon as a map is on the disk, whatever is being written by then.
TEST_F(Slam6dNodeInASavedMap, AfterAKillTheLastWholeMapIsCarriedOnWith) {
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

TEST_F(Slam6dNodeInASavedMap, ARobotThatIsNotFoundChangesNothing) {
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

TEST(Slam6dNode, BadMessagesAreCountedByCause) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "bad.lcmlog");
  log.add_drive(true);
  nodmap::scan_t scan{};  // no orientation, no step: nothing is filled in
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

TEST(Slam6dNode, WithoutOdometryScansAreRejectedOrStandingIsAssumed) {
  const test::TemporaryDir dir;
  LogFile log(dir.path() / "still.lcmlog");
  log.add_drive(false);
  log.close();
  const Outcome rejected = replay(dir.path(), "still", {});
  EXPECT_EQ(rejected.counts.rejected().at("no_odometry"), 320);
  EXPECT_EQ(rejected.health.state, node::HealthState::kDegraded);
  fs::remove_all(dir.path() / "out_still");
  const Outcome standing = replay(dir.path(), "still", {.assume_stationary = true});
  EXPECT_EQ(standing.counts.used(), 320);
  EXPECT_EQ(standing.metrics["keyframes"].size(), 1U);
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
  // The second sweep beyond 2 m is complete before the end; on request; at the end.
  EXPECT_EQ(outcome.metrics["occupancy_map"]["times_saved"], 4);
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
  put_scans(75);  // within a second it has been tried
  EXPECT_EQ(slam.health().state, node::HealthState::kDegraded);
  fs::create_directory(context.out_dir);
  put_scans(600);
  EXPECT_FALSE(fs::exists(context.out_dir / "map.bt")) << "not at once";
  put_scans(225);  // 12 s after the request
  EXPECT_TRUE(fs::exists(context.out_dir / "map.bt"));
  EXPECT_EQ(slam.health().state, node::HealthState::kOk) << slam.health().reason;
}

}  // namespace node_test
}  // namespace nodmap::slam6d
