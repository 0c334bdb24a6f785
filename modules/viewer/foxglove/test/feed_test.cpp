// SPDX-License-Identifier: BSD-3-Clause
// Sends every channel to the store through a bus in memory.
#include "modules/viewer/foxglove/feed.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/bus/loop_bus.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "modules/viewer/foxglove/test/robot_maps.hpp"
#include "modules/viewer/foxglove/test/robot_messages.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::foxglove {
namespace feed_test {

namespace robot = test;

class FeedTest : public ::testing::Test {
 protected:
  explicit FeedTest(const FeedParams& params = {.cloud_spacing_m = 0.0})
      : feed_(bus_, store_, counts_, params) {}

  template <class Message>
  void send(const char* channel, const Message& message) {
    bus_.publish(channel, message);
    while (bus_.handle(std::chrono::milliseconds(0)) > 0) {
    }
  }

  // Two keyframes, one second apart, with the same points.
  void send_keyframe_twice() {
    for (const std::int64_t id : {0, 1}) {
      for (auto chunk : robot::keyframe_at(0.0, id, 1000)) {
        chunk.utime += 1'000'000 * id;
        send("CLOUD", chunk);
      }
    }
  }

  std::size_t count_posts(const std::string& name) const {
    std::uint64_t cursor = 0;
    std::size_t posts = 0;
    while (store_.next(topic(name), cursor)) {
      ++posts;
    }
    return posts;
  }

  std::size_t topic(const std::string& name) const {
    for (std::size_t i = 0; i < store_.topics().size(); ++i) {
      if (store_.topics()[i].name == name) {
        return i;
      }
    }
    ADD_FAILURE() << "no topic " << name;
    return 0;
  }

  // The newest message on a topic; null if there is none.
  Json newest(const std::string& name) const {
    std::uint64_t cursor = 0;
    const auto post = store_.next(topic(name), cursor);
    return post ? Json::parse(post->text()) : Json();
  }

  bus::LiveBus bus_{"memq://"};
  TopicStore store_;
  node::MessageCounts counts_;
  Feed feed_;
};

class DownsampledFeedTest : public FeedTest {
 protected:
  DownsampledFeedTest() : FeedTest({.cloud_spacing_m = 0.05}) {}
};

TEST_F(FeedTest, EveryTopicHasASchemaAndANameOfItsOwn) {
  std::set<std::string> names;
  for (const Topic& topic : store_.topics()) {
    EXPECT_NO_THROW((void)schema_text(topic.schema_name)) << topic.schema_name;
    EXPECT_TRUE(names.insert(topic.name).second) << topic.name;
  }
}

TEST_F(FeedTest, OdometryGivesTheBaseFrameTheTrailAndTheBody) {
  send("ODOMETRY", robot::odometry_at(2.0));
  EXPECT_DOUBLE_EQ(newest("ODOMETRY")["forward_mps"], 0.5);
  EXPECT_DOUBLE_EQ(newest("tf/base")["translation"]["x"], 1.0);
  EXPECT_EQ(newest("tf/base")["parent_frame_id"], "odom");
  EXPECT_EQ(newest("trail/odometry")["poses"].size(), 1U);
  EXPECT_EQ(newest("scene/robot")["entities"][0]["id"], "robot");
}

FeedParams other_robot() {
  FeedParams params;
  params.robot.body.length_m = 0.8;
  params.robot.body.width_m = 0.6;
  params.robot.mount.x_m = 0.3;
  params.robot.mount.z_m = 0.9;
  return params;
}

class OtherRobotFeedTest : public FeedTest {
 protected:
  OtherRobotFeedTest() : FeedTest(other_robot()) {}
};

TEST_F(OtherRobotFeedTest, IsDrawnByItsParameters) {
  send("ODOMETRY", robot::odometry_at(2.0));
  const Json chassis = newest("scene/robot")["entities"][0]["cubes"][0];
  EXPECT_EQ(chassis["size"]["x"], 0.8);
  EXPECT_EQ(chassis["size"]["y"], 0.6);
  send("PITCH_COMMAND", robot::pitch_command_at(0.0));  // before the first scan
  const Json axis = newest("scene/area_of_interest")["entities"][0]["lines"][0]["points"][0];
  EXPECT_EQ(axis["x"], 0.3);
  EXPECT_EQ(axis["z"], 0.9);
}

TEST_F(FeedTest, TheFrameOfThe6dMapIsAChildOfOdom) {
  send("POSE_2D", robot::pose_at(10.0));
  send("POSE_6D", robot::pose_at(10.0));
  EXPECT_EQ(newest("tf/map")["child_frame_id"], "odom");
  EXPECT_DOUBLE_EQ(newest("tf/map")["translation"]["y"], 0.1);
  EXPECT_EQ(newest("tf/map_6d")["parent_frame_id"], "odom");
  EXPECT_DOUBLE_EQ(newest("tf/map_6d")["translation"]["y"], -0.1);
}

TEST_F(FeedTest, ConvertsMapsAndClouds) {
  for (const auto& tile : robot::map_at(0.0, 1)) {
    send("MAP_2D", tile);
  }
  for (const auto& chunk : robot::keyframe_at(0.0, 0, 12'000)) {
    send("CLOUD", chunk);
  }
  for (const auto& chunk : robot::octomap_at(0.0, 0)) {
    send("OCTOMAP", chunk);
  }
  send("OBSTACLE_MAP", robot::egomap_at(0.0));
  EXPECT_EQ(newest("OCTOMAP")["column_count"], 60);
  EXPECT_EQ(newest("OCTOMAP")["row_count"], 42);
  EXPECT_EQ(newest("MAP_2D")["column_count"], 120);
  EXPECT_EQ(newest("CLOUD")["frame_id"], "map_6d");
  EXPECT_EQ(newest("keyframes")["poses"].size(), 1U);
  EXPECT_EQ(newest("OBSTACLE_MAP")["point_stride"], 16);
  EXPECT_EQ(newest("STRUCTURE_MAP"), Json());
}

// A loop closure also moves keyframes shown before; pages find each cloud by its time.
TEST_F(FeedTest, ALoopClosureMovesTheKeyframes) {
  for (const auto& chunk : robot::keyframe_at(0.0, 0, 10)) {
    send("CLOUD", chunk);
  }
  const Json before = newest("keyframes");
  ASSERT_EQ(before["poses"].size(), 1U);
  EXPECT_EQ(before["times"][0], newest("CLOUD")["timestamp"]);
  send("POSE_GRAPH_6D", robot::pose_graph_6d());
  const Json after = newest("keyframes");
  ASSERT_EQ(after["poses"].size(),
            2U);  // including the second, whose cloud has not been received yet
  EXPECT_EQ(after["times"][0], before["times"][0]);
  EXPECT_EQ(after["poses"][0]["position"]["x"], 2.0);
  EXPECT_EQ(newest("scene/pose_graph_6d")["entities"].size(), 1U);
}

// The graph has the first and the third keyframe, 2 m ahead and turned left. The second one, which
// the map has dropped, is still shown, and remains where it was relative to the first.
TEST_F(FeedTest, ALoopClosureMovesDroppedKeyframesWithTheOthers) {
  for (const std::int64_t id : {0, 1, 2}) {
    for (auto chunk : robot::keyframe_at(0.0, id, 10)) {
      chunk.utime += 1'000'000 * id;
      chunk.position_m[0] = static_cast<double>(id);
      send("CLOUD", chunk);
    }
  }
  nodmap::pose_graph_6d_t graph = robot::pose_graph_6d();
  graph.keyframe_utime[1] = graph.keyframe_utime[0] + 2'000'000;
  for (std::vector<float>& orientation : graph.orientation) {
    orientation = {std::sqrt(0.5F), 0.0F, 0.0F, std::sqrt(0.5F)};
  }
  send("POSE_GRAPH_6D", graph);
  const Json poses = newest("keyframes")["poses"];
  ASSERT_EQ(poses.size(), 3U);
  const Json& first = poses[0]["position"];
  EXPECT_EQ(first["x"], 2.0);
  EXPECT_NEAR(poses[1]["position"]["x"], first["x"], 1e-6);
  EXPECT_NEAR(poses[1]["position"]["y"], first["y"].get<double>() + 1.0, 1e-6);
}

TEST_F(FeedTest, AKeyframeOfAPlaceShownBeforeIsShownAsWell) {
  send_keyframe_twice();
  EXPECT_EQ(count_posts("CLOUD"), 2U);
}

TEST_F(DownsampledFeedTest, AKeyframeOfAPlaceShownBeforeIsCountedButNotShown) {
  send_keyframe_twice();
  EXPECT_EQ(count_posts("CLOUD"), 1U);
  EXPECT_EQ(newest("keyframes")["poses"].size(), 2U);
  feed_.reset();
  store_.clear();
  send_keyframe_twice();
  EXPECT_EQ(count_posts("CLOUD"), 1U);
}

// 6D SLAM and the one that is started after it, each with a socket of its own.
class RestartedSlam6d : public ::testing::Test {
 protected:
  // A keyframe of 1000 points that were measured at this time; all see the same places.
  void send_keyframe(bus::Bus& sender, std::int64_t time_s) {
    for (auto chunk : robot::keyframe_at(0.0, 0, 1000)) {
      chunk.utime = 1'000'000 * time_s;
      sender.publish("CLOUD", chunk);
    }
    network_.deliver();
  }

  // The times of all messages that a topic keeps, seconds.
  [[nodiscard]] std::vector<std::int64_t> kept(const std::string& name) const {
    std::vector<std::int64_t> times;
    for (std::size_t i = 0; i < store_.topics().size(); ++i) {
      std::uint64_t cursor = 0;
      while (const auto post = store_.topics()[i].name == name ? store_.next(i, cursor) : nullptr) {
        times.push_back(time::to_utime(post->stamp()) / 1'000'000);
      }
    }
    return times;
  }

  // The times of the keyframes whose poses are shown, seconds.
  [[nodiscard]] std::vector<std::int64_t> shown_poses() const {
    std::vector<std::int64_t> times;
    for (std::size_t i = 0; i < store_.topics().size(); ++i) {
      std::uint64_t cursor = 0;
      if (store_.topics()[i].name == "keyframes") {
        const Json poses = Json::parse(store_.next(i, cursor)->text());
        for (const Json& stamp : poses["times"]) {
          times.push_back(stamp["sec"]);
        }
      }
    }
    return times;
  }

  using Times = std::vector<std::int64_t>;
  nodmap::test::TemporaryDir dir_;
  bus::LoopNetwork network_{dir_.path() / "log", {}};
  bus::LoopBus bus_{network_};
  bus::LoopBus first_{network_};
  bus::LoopBus second_{network_};
  TopicStore store_;
  node::MessageCounts counts_;
  Feed feed_{bus_, store_, counts_, {.cloud_spacing_m = 0.05}};
};

TEST_F(RestartedSlam6d, BeginsAnotherMap) {
  send_keyframe(first_, 10);
  send_keyframe(second_, 20);
  EXPECT_EQ(kept("CLOUD"), Times{20}) << "also where the first one had measured points";
  EXPECT_EQ(shown_poses(), Times{20});
  send_keyframe(first_, 30);  // it has not ended, or its message was delayed
  EXPECT_EQ(kept("CLOUD"), Times{20});
  EXPECT_EQ(shown_poses(), Times{20});
  EXPECT_EQ(counts_.rejected().at("former_sender_of_cloud"), 1);
}

// As when it has learned how the laser is mounted: the same process numbers the same keyframes from
// the start again.
TEST_F(RestartedSlam6d, AMapThatBeginsAgainReplacesTheCloud) {
  send_keyframe(first_, 10);
  send_keyframe(first_, 20);
  EXPECT_EQ(kept("CLOUD"), Times{20}) << "also where the first map had points";
  EXPECT_EQ(shown_poses(), Times{20});
}

// The graph of a saved map comes before its clouds.
TEST_F(RestartedSlam6d, BeginsAnotherMapWithItsPoseGraph) {
  send_keyframe(first_, 10);
  nodmap::pose_graph_6d_t graph = robot::pose_graph_6d();
  graph.keyframe_utime = {20'000'000, 21'000'000};
  second_.publish("POSE_GRAPH_6D", graph);
  network_.deliver();
  EXPECT_EQ(kept("CLOUD"), Times{});
  EXPECT_EQ(shown_poses(), (Times{20, 21}));
  send_keyframe(second_, 20);
  EXPECT_EQ(shown_poses(), (Times{20, 21}));
}

TEST_F(FeedTest, ConvertsAllOtherChannels) {
  send("SCAN", robot::scan_at(0.0));
  send("PITCH_STATE", robot::pitch_state_at(0.3));
  send("PITCH_COMMAND", robot::pitch_command_at(0.0));
  send("DRIVE", robot::drive_at(0.0));
  send("NAVIGATION", robot::navigation_at(0.0));
  send("GOAL", robot::goal());
  send("PATH", robot::path());
  send("TRACKS", robot::tracks());
  send("LOCAL_MAP", robot::local_map());
  send("EXPLORATION", robot::exploration());
  send("POSE_GRAPH", robot::pose_graph());
  send("POSE_GRAPH_6D", robot::pose_graph_6d());
  send("TRUTH", robot::truth_at(0.0));
  send("STATUS", robot::status_at(0.0));
  send("STOP", robot::stop());
  send("BASE_SENSORS", robot::base_sensors_at(0.0));
  send("PM_INFO", robot::deputy_info_at(0.0));
  EXPECT_EQ(newest("SCAN")["ranges"].size(), 361U);
  EXPECT_DOUBLE_EQ(newest("PITCH_STATE")["pitch_rad"], 0.4);
  EXPECT_DOUBLE_EQ(newest("PITCH_COMMAND")["sweep_s"], 0.6);
  EXPECT_DOUBLE_EQ(newest("DRIVE")["forward_mps"], 0.5);
  EXPECT_TRUE(newest("NAVIGATION")["clear_distance_m"].is_null());
  EXPECT_EQ(newest("scene/corridor")["entities"].size(), 1U);
  EXPECT_EQ(newest("scene/area_of_interest")["entities"].size(), 1U);
  EXPECT_EQ(newest("scene/goal")["entities"].size(), 1U);
  EXPECT_EQ(newest("scene/path")["entities"].size(), 1U);
  EXPECT_EQ(newest("scene/tracks")["entities"].size(), 1U);
  EXPECT_EQ(newest("LOCAL_MAP")["column_count"], 80);
  EXPECT_EQ(newest("EXPLORATION")["state_name"], "EXPLORING");
  EXPECT_EQ(newest("scene/exploration")["entities"].size(), 1U);
  EXPECT_EQ(newest("scene/pose_graph")["entities"].size(), 1U);
  EXPECT_EQ(newest("scene/people")["entities"][0]["cylinders"].size(), 1U);
  EXPECT_DOUBLE_EQ(newest("tf/world")["translation"]["x"], -3.0);
  EXPECT_EQ(newest("STATUS")["processes"].size(), 1U);
  EXPECT_EQ(newest("STOP")["is_stopped"], false);
  EXPECT_EQ(newest("stop_state")["state"], "RELEASED");
  EXPECT_TRUE(newest("BASE_SENSORS")["sonar_m"].is_null());
  EXPECT_EQ(newest("PM_INFO")["commands"][0]["process_name"], "nodmap-slam2d");
  EXPECT_EQ(newest("log")["name"], "nodmap-slam2d");
  EXPECT_EQ(counts_.total_rejected(), 0);
}

TEST_F(FeedTest, MessagesThatCannotBeShownAreCounted) {
  nodmap::odometry_t odometry = robot::odometry_at(0.0);
  odometry.position_m[0] = std::numeric_limits<double>::quiet_NaN();
  send("ODOMETRY", odometry);
  nodmap::scan_t scan = robot::scan_at(0.0);
  scan.angle_step_rad = std::numeric_limits<double>::quiet_NaN();
  send("SCAN", scan);
  EXPECT_EQ(counts_.rejected().at("pose_not_valid"), 1);
  EXPECT_EQ(counts_.rejected().at("scan_not_plausible"), 1);
  EXPECT_EQ(newest("ODOMETRY"), Json());
}

// A reader may get only the newest message of STOP, which is the viewer's most of the time.
TEST_F(FeedTest, TheStateOfStopOutlastsRepetitions) {
  nodmap::stop_t stop = robot::stop();
  stop.is_stopped = 1;
  send("STOP", stop);
  EXPECT_EQ(newest("stop_state")["state"], "SENT");
  nodmap::stop_t confirmation = stop;
  confirmation.requested_by = "nodmap-kurt, for nodmap-viewer";
  send("STOP", confirmation);
  send("STOP", stop);
  EXPECT_EQ(newest("STOP")["requested_by"], "nodmap-viewer");
  EXPECT_EQ(newest("stop_state")["state"], "STOPPED");
  EXPECT_EQ(newest("stop_state")["by"], "nodmap-kurt, for nodmap-viewer");
  feed_.reset();
  store_.clear();
  send("STOP", stop);
  EXPECT_EQ(newest("stop_state")["state"], "SENT") << "a recording starts again";
}

TEST_F(FeedTest, AResetDropsTrailsAndMaps) {
  send("ODOMETRY", robot::odometry_at(0.0));
  feed_.reset();
  store_.clear();
  send("ODOMETRY", robot::odometry_at(0.0));
  EXPECT_EQ(newest("trail/odometry")["poses"].size(), 1U);
  EXPECT_FALSE(newest("scene/robot").is_null());
}

}  // namespace feed_test
}  // namespace nodmap::foxglove
