// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/formats/input_file.hpp"
#include "common/node/messages.hpp"
#include "modules/slam2d/back_end/saved_map_file.hpp"
#include "modules/slam2d/node.hpp"
#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"
#include "nodmap/keyframe_2d_t.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::slam2d {
namespace saved_map_test {

using geometry::SE2;

// One run of the process in room(). Odometry begins at an arbitrary pose and counts 3 % too much.
class Session {
 public:
  Session() : node_(context_, Slam2dParams{}) {}
  explicit Session(const std::filesystem::path& map_in,
                   const std::optional<SE2>& T_map_start = std::nullopt)
      : node_(context_, Slam2dParams{}, {{}, map_in, T_map_start}) {}

  void drive(SE2& truth, int num_scans, const SE2& step) {
    for (int i = 0; i < num_scans; ++i) {
      stamp_ += 200ms;
      auto odometry = node::write_odometry(stamp_, geometry::to_se3(odom_));
      odometry.odometry_seq = seq_;
      bus_.deliver("ODOMETRY", odometry);
      scan::Scan scan = scanner_.scan(test::room(), truth, stamp_);
      scan.seq = seq_++;
      bus_.deliver("SCAN", node::write_scan(scan));
      truth = truth * step;
      odom_ = odom_ * SE2{1.03 * step.x, 1.03 * step.y, step.yaw};
    }
  }
  // Drives on while the base driver is away.
  void move_unseen(SE2& truth, const SE2& motion, time::Duration duration) {
    truth = truth * motion;
    stamp_ += duration;
  }
  void finish_into(const std::filesystem::path& dir) {
    node_.finish();
    node_.write_results(dir);
  }
  [[nodiscard]] nodmap::pose_t last_pose() const { return bus_.last<nodmap::pose_t>("POSE_2D"); }
  [[nodiscard]] std::size_t num_poses() const {
    return bus_.sent<nodmap::pose_t>("POSE_2D").size();
  }
  Slam2dNode& node() { return node_; }

 private:
  nodmap::test::MemoryBus bus_;
  node::MessageCounts counts_;
  node::Context context_{bus_, counts_, {}};
  Slam2dNode node_;
  test::Scanner scanner_;
  SE2 odom_{4.0, -7.0, 2.0};
  time::Timestamp stamp_{};
  std::int64_t seq_ = 0;
};

// The map frame is the odom frame of the first run, which began at the origin of room().
constexpr SE2 kMapOfRoom{4.0, -7.0, 2.0};

// Saves the map of a drive on a circle of 0.75 m radius, from the origin of room().
void map_room(const std::filesystem::path& dir) {
  Session run;
  SE2 truth;
  run.drive(truth, 160, {0.03, 0.0, 0.04});
  run.finish_into(dir);
}

std::vector<nodmap::keyframe_2d_t> keyframes_in(const std::filesystem::path& file) {
  std::vector<nodmap::keyframe_2d_t> keyframes;
  bus::LogReader log(file);
  while (const bus::LogEvent* event = log.next()) {
    nodmap::keyframe_2d_t message;
    if (bus::decode_into(message, event->data)) {
      keyframes.push_back(message);
    }
  }
  return keyframes;
}

TEST(SavedMap, IsReadAsItWasWritten) {
  const nodmap::test::TemporaryDir dir;
  test::Slam slam;
  test::Scanner scanner;
  SE2 truth;
  for (int i = 0; i < 600; ++i) {
    track(slam, scanner.scan(test::room(), truth, time::Timestamp(test::kPeriod * i)), truth);
    truth = truth * SE2{0.03, 0.0, 0.04};
  }
  SavedMap written = slam.back_end().save();
  written.cleared = {{{{-1.5, 2.0}, {0.25, 3.0}}, 7}};
  written.variance_factor = {900.0, 100.0};
  ASSERT_GT(written.submaps.size(), 3U);
  ASSERT_FALSE(written.loops.empty());
  ASSERT_FALSE(write_saved_map(dir.path(), written));
  const SavedMap read = read_saved_map(dir.path());

  ASSERT_EQ(read.keyframes.size(), written.keyframes.size());
  ASSERT_EQ(read.steps.size(), written.steps.size());
  for (std::size_t k = 0; k < read.keyframes.size(); ++k) {
    EXPECT_EQ(read.keyframes[k].stamp, written.keyframes[k].stamp);
    EXPECT_EQ(read.keyframes[k].points_base, written.keyframes[k].points_base);
    EXPECT_EQ(read.keyframes[k].normals_base, written.keyframes[k].normals_base);
    EXPECT_EQ(distance_m(read.keyframes[k].T_map_base, written.keyframes[k].T_map_base), 0.0);
  }
  for (std::size_t k = 0; k < read.steps.size(); ++k) {
    EXPECT_EQ(read.steps[k].from, k);
    EXPECT_EQ(read.steps[k].to, k + 1);
    EXPECT_EQ(read.steps[k].information, written.steps[k].information);
  }
  ASSERT_EQ(read.submaps.size(), written.submaps.size());
  for (std::size_t s = 0; s < read.submaps.size(); ++s) {
    EXPECT_EQ(read.submaps[s].first_keyframe, written.submaps[s].first_keyframe);
    EXPECT_EQ(read.submaps[s].end_keyframe, written.submaps[s].end_keyframe);
  }
  ASSERT_EQ(read.loops.size(), written.loops.size());
  for (std::size_t i = 0; i < read.loops.size(); ++i) {
    EXPECT_EQ(read.loops[i].edge.to, written.loops[i].edge.to);
    EXPECT_EQ(read.loops[i].edge.information, written.loops[i].edge.information);
  }
  EXPECT_EQ(read.variance_factor.value(), 3.0);
  EXPECT_EQ(read.variance_factor.num_loops(), 100.0);
  ASSERT_EQ(read.cleared.size(), 1U);
  EXPECT_EQ(read.cleared[0].region.low, written.cleared[0].region.low);
  EXPECT_EQ(read.cleared[0].region.high, written.cleared[0].region.high);
  EXPECT_EQ(read.cleared[0].num_keyframes, 7U);
}

TEST(SavedMap, ALoopThatLeavesADirectionUndeterminedIsReadAsItWasWritten) {
  const nodmap::test::TemporaryDir dir;
  map_room(dir.path());
  SavedMap written = read_saved_map(dir.path());
  ASSERT_GT(written.submaps.size(), 1U);
  written.loops.resize(1);
  written.loops[0].edge.to = 1;
  for (const double along_corridor : {0.0, -1e-9}) {  // rounding may make it negative
    written.loops[0].edge.information = Eigen::Vector3d(along_corridor, 4e4, 1e6).asDiagonal();
    ASSERT_FALSE(write_saved_map(dir.path(), written));
    const SavedMap read = read_saved_map(dir.path());
    EXPECT_EQ(read.loops.at(0).edge.information, written.loops[0].edge.information);
  }
}

TEST(SavedMap, IsTheSameAfterRestoringAndSavingAgain) {
  const nodmap::test::TemporaryDir dir;
  map_room(dir.path());
  SavedMap read = read_saved_map(dir.path());
  read.variance_factor = {900.0, 100.0};
  const Slam2dParams params;
  BackEnd back_end(params.back_end, params.map, params.matcher);
  back_end.restore(read);
  EXPECT_FALSE(back_end.has_local());
  const SavedMap again = back_end.save();
  EXPECT_EQ(again.keyframes.size(), read.keyframes.size());
  EXPECT_EQ(again.submaps.size(), read.submaps.size());
  EXPECT_EQ(again.variance_factor.value(), 3.0);
  ASSERT_EQ(again.loops.size(), read.loops.size());
  for (std::size_t i = 0; i < read.loops.size(); ++i) {
    EXPECT_EQ(again.loops[i].edge.from, read.loops[i].edge.from);
    // The relative pose was rounded once.
    EXPECT_LT(distance_m(again.loops[i].edge.T_from_to, read.loops[i].edge.T_from_to), 1e-9);
  }
}

// The second run begins elsewhere in the room, with another heading and another odom frame.
TEST(SavedMap, IsContinuedFromAnUnknownStartPose) {
  const nodmap::test::TemporaryDir first;
  const nodmap::test::TemporaryDir second;
  map_room(first.path());
  const std::size_t saved = read_saved_map(first.path()).keyframes.size();

  Session run(first.path());
  SE2 truth{1.0, -0.7, 2.0};
  run.drive(truth, 1, {0.03, 0.0, -0.04});
  EXPECT_NE(run.last_pose().state, nodmap::pose_t::TRACKING) << "not confirmed yet";
  EXPECT_EQ(run.node().metrics()["keyframes"], saved) << "nothing is added before";
  EXPECT_EQ(run.node().metrics()["localisation"]["searches_found"], 1);
  for (int i = 0; i < 120; ++i) {
    const SE2 now = truth;
    run.drive(truth, 1, {0.03, 0.0, -0.04});
    if (i > 40) {
      const nodmap::pose_t pose = run.last_pose();
      EXPECT_EQ(pose.state, nodmap::pose_t::TRACKING);
      const SE2 expected = kMapOfRoom * now;
      // The tolerance is a cell of the grid in which the place was found.
      EXPECT_NEAR(pose.position_m[0], expected.x, 0.05) << i;
      EXPECT_NEAR(pose.position_m[1], expected.y, 0.05) << i;
    }
  }
  run.finish_into(second.path());
  const SavedMap carried_on = read_saved_map(second.path());
  EXPECT_GT(carried_on.keyframes.size(), saved + 5);
  EXPECT_EQ(run.node().metrics()["scans_used"], run.num_poses());
  bool has_loop_between_runs = false;
  const std::size_t submaps_before = read_saved_map(first.path()).submaps.size();
  for (const SavedMap::Loop& loop : carried_on.loops) {
    has_loop_between_runs |= loop.edge.from < submaps_before && loop.edge.to >= submaps_before;
  }
  EXPECT_TRUE(has_loop_between_runs);
  // The keyframes of the first run stay where they were.
  EXPECT_LT(distance_m(carried_on.keyframes[0].T_map_base, kMapOfRoom), 1e-9);
}

TEST(SavedMap, IsContinuedAtOnceFromAGivenStartPose) {
  const nodmap::test::TemporaryDir dir;
  map_room(dir.path());
  const std::size_t saved = read_saved_map(dir.path()).keyframes.size();
  SE2 truth{1.0, -0.7, 2.0};
  Session run(dir.path(), kMapOfRoom * truth);
  run.drive(truth, 2, {0.03, 0.0, -0.04});
  EXPECT_EQ(run.last_pose().state, nodmap::pose_t::TRACKING);
  EXPECT_EQ(run.node().metrics()["keyframes"], saved + 1);
}

// The base driver is away just after the robot was found, while somebody pushes it.
TEST(SavedMap, IsContinuedWhereTheRobotIsAfterAGapInOdometry) {
  const nodmap::test::TemporaryDir dir;
  map_room(dir.path());
  SE2 truth{1.0, -0.7, 2.0};
  Session run(dir.path(), kMapOfRoom * truth);
  run.drive(truth, 1, {});
  ASSERT_EQ(run.last_pose().state, nodmap::pose_t::TRACKING);
  run.move_unseen(truth, {-0.6, 0.8, 0.4}, 2s);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d expected = (kMapOfRoom * truth).translation();
    run.drive(truth, 1, {0.03, 0.0, -0.04});
    const nodmap::pose_t pose = run.last_pose();
    EXPECT_NE(pose.state, nodmap::pose_t::LOST) << i;
    // A cell of the grid in which the place was found.
    EXPECT_NEAR(pose.position_m[0], expected.x(), 0.05) << i;
    EXPECT_NEAR(pose.position_m[1], expected.y(), 0.05) << i;
  }
}

TEST(SavedMap, OfAnEarlierVersionHasTheVarianceFactorOfANewOne) {
  const nodmap::test::TemporaryDir dir;
  map_room(dir.path());
  const std::filesystem::path file = dir.path() / "old.lcmlog";
  {
    bus::LogReader log(dir.path() / "keyframes.lcmlog");
    bus::LogWriter old(file);
    while (const bus::LogEvent* event = log.next()) {
      if (event->channel != "LOOP_STATISTICS_2D") {
        EXPECT_TRUE(old.write(event->log_utime_us, event->channel, event->data));
      }
    }
  }
  EXPECT_EQ(read_saved_map(file).variance_factor.num_loops(), VarianceFactor().num_loops());
}

TEST(SavedMap, StaysUnchangedIfTheRobotIsNotInIt) {
  const nodmap::test::TemporaryDir dir;
  map_room(dir.path());
  Session run(dir.path());
  SE2 truth{50.0, 50.0, 0.0};  // nothing in view
  run.drive(truth, 20, {0.03, 0.0, 0.0});
  EXPECT_EQ(run.last_pose().state, nodmap::pose_t::LOST);
  EXPECT_EQ(run.node().metrics()["scans_lost"], 20);
  EXPECT_EQ(run.node().metrics()["keyframes"], read_saved_map(dir.path()).keyframes.size());
  EXPECT_EQ(run.node().health().state, node::HealthState::kDegraded);
}

// Writes the keyframes of a valid map after `spoil` has changed them, reads them and returns the
// error; empty if there is none.
std::string error_after(const std::function<void(std::vector<nodmap::keyframe_2d_t>&)>& spoil) {
  const nodmap::test::TemporaryDir good;
  const nodmap::test::TemporaryDir bad;
  map_room(good.path());
  std::vector<nodmap::keyframe_2d_t> keyframes = keyframes_in(good.path() / "keyframes.lcmlog");
  spoil(keyframes);
  const std::filesystem::path file = bad.path() / "keyframes.lcmlog";
  {
    bus::LogWriter writer(file);
    std::vector<std::byte> bytes;
    for (const nodmap::keyframe_2d_t& keyframe : keyframes) {
      bus::encode_into(bytes, keyframe);
      EXPECT_TRUE(writer.write(keyframe.utime, "KEYFRAME_2D", bytes));
    }
    EXPECT_TRUE(writer.flush());
  }
  try {
    (void)read_saved_map(file);
  } catch (const formats::InputFileError& error) {
    EXPECT_EQ(std::string(error.what()).find(file.string()), 0U) << error.what();
    return std::string(error.what()).substr(file.string().size());
  }
  return "";
}

TEST(SavedMap, WithImpossibleValuesIsRefused) {
  using Keyframes = std::vector<nodmap::keyframe_2d_t>;
  EXPECT_EQ(error_after([](Keyframes&) {}), "");
  EXPECT_NE(error_after([](Keyframes& k) { k.resize(1), k[0].first_submap = 1; }), "");
  EXPECT_NE(error_after([](Keyframes& k) { k[3].last_submap = 2'000'000'000; }), "");
  EXPECT_NE(error_after([](Keyframes& k) { k[3].first_submap = -1; }), "");
  EXPECT_NE(error_after([](Keyframes& k) { k[3].map_from_base[0] = 5e8; }), "");
  EXPECT_NE(error_after([](Keyframes& k) { k[3].points_m[7][1] = std::nanf(""); }), "");
  EXPECT_NE(error_after([](Keyframes& k) { k[3].step_information[1][1] = -1.0; }), "");
  EXPECT_NE(error_after([](Keyframes& k) {
              auto& information = k[3].step_information;
              information[0][1] = information[1][0] =
                  2.0 * std::max(information[0][0], information[1][1]);
            }),
            "");
  EXPECT_NE(error_after([](Keyframes& k) { k[3].sensor_origin_m[0] = std::nan(""); }), "");
  // Rays from there would take a gigabyte.
  EXPECT_NE(error_after([](Keyframes& k) { k[3].sensor_origin_m[0] = 10'000.0; }), "");
  EXPECT_NE(error_after([](Keyframes& k) { k[3].points_m[7][1] = 10'000.0F; }), "");
  EXPECT_NE(error_after([](Keyframes& k) { k[3].normals[7][0] = 2.0F; }), "");
  EXPECT_NE(
      error_after([](Keyframes& k) { k[3].step[2] = std::numeric_limits<double>::infinity(); }),
      "");
}

TEST(SavedMap, ThatIsTruncatedOrMissingIsRefused) {
  const nodmap::test::TemporaryDir dir;
  map_room(dir.path());
  const std::filesystem::path file = dir.path() / "keyframes.lcmlog";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 10);
  EXPECT_THROW((void)read_saved_map(dir.path()), formats::InputFileError);
  EXPECT_THROW((void)read_saved_map(dir.path() / "nowhere"), formats::InputFileError);
}

TEST(SavedMap, AMapOfAnotherProgramIsSaidToHaveNoKeyframes) {
  const nodmap::test::TemporaryDir dir;
  const std::filesystem::path file = dir.path() / "map.yaml";
  std::ofstream(file) << "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
  try {
    (void)read_saved_map(file);
    ADD_FAILURE() << "it was read";
  } catch (const formats::InputFileError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(file.string() + ": contains no keyframes"))
        << error.what();
  }
}

}  // namespace saved_map_test
}  // namespace nodmap::slam2d
