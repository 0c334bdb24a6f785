// SPDX-License-Identifier: BSD-3-Clause
// Messages as Foxglove's schemas, compared with values computed by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "common/node/messages.hpp"
#include "modules/viewer/foxglove/pose_views.hpp"
#include "modules/viewer/foxglove/process_tables.hpp"
#include "modules/viewer/foxglove/scene_views.hpp"
#include "modules/viewer/foxglove/sensor_views.hpp"
#include "modules/viewer/foxglove/test/robot_log.hpp"
#include "nodmap/json_messages.hpp"

namespace nodmap::foxglove {
namespace views_test {

/// An independent decoder, by table look-up for 4 characters at a time.
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

TEST(Foxglove, TimeIsSecondsAndNanoseconds) {
  EXPECT_EQ(time_json(time::from_utime(1'700'000'000'000'042)),
            Json({{"sec", 1'700'000'000}, {"nsec", 42'000}}));
  EXPECT_EQ(time_json(time::from_utime(-5)), Json({{"sec", 0}, {"nsec", 0}}));
}

TEST(Foxglove, BytesThatAreNoTextDoNoHarm) {
  EXPECT_TRUE(Json::accept(to_text(Json({{"name", "\xFF\xFE slam"}}))));
}

std::string encoded(std::string_view text) {
  return base64(std::as_bytes(std::span(text)));
}

// RFC 4648, section 10.
TEST(Base64, AgreesWithTheVectorsOfTheRfc) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Base64, TakesEveryByte) {
  EXPECT_EQ(encoded("\xFF\xEF\xBE"), "/+++");
  EXPECT_EQ(encoded(std::string_view("\0\0\0", 3)), "AAAA");
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

TEST(LaserScan, HasTheFanAndZeroWhereThereIsNoReading) {
  const Json json = laser_scan(level_scan());
  EXPECT_EQ(json["ranges"], Json({1.5, 0.0, 0.0}));
  EXPECT_DOUBLE_EQ(json["start_angle"], -0.5);
  EXPECT_DOUBLE_EQ(json["end_angle"], 0.5);
  EXPECT_EQ(json["timestamp"], time_json(time::from_utime(5'000'000)));
  EXPECT_EQ(json["frame_id"], "base");
}

// The page and Foxglove draw p_base = pose * (r cos a, r sin a, 0): the same as Eq. 1 when the
// pitch does not change during the scan.
TEST(LaserScan, PlacesABeamWhereTheEquationDoes) {
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

TEST(EgomapCloud, HoldsThePointsThatAreThere) {
  nodmap::egomap_t map = foxglove::test::egomap_at(1.0);
  const Json json = egomap_cloud(map, geometry::SE3::Identity());
  const std::vector<float> values = floats_in(json);
  const auto seen = static_cast<std::size_t>(std::count_if(
      map.distance_m.begin(), map.distance_m.end(), [](float d) { return std::isfinite(d); }));
  ASSERT_GT(seen, 0U);
  ASSERT_LT(seen, map.distance_m.size());
  ASSERT_EQ(values.size(), 4 * seen);
  const std::size_t first =
      static_cast<std::size_t>(std::find_if(map.distance_m.begin(), map.distance_m.end(),
                                            [](float d) { return std::isfinite(d); }) -
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

TEST(Grid, KeepsCellsAndCorner) {
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

TEST(Grid, ALocalMapIsWhatItSays) {
  const nodmap::local_map_t good = foxglove::test::local_map();
  EXPECT_TRUE(is_valid(good));
  nodmap::local_map_t bad = good;
  bad.width = 81;
  EXPECT_FALSE(is_valid(bad));
  bad = good;
  bad.width = bad.height = -80;  // their product is right
  EXPECT_FALSE(is_valid(bad));
  bad = good;
  bad.width = 1;
  bad.height = bad.num_cells;  // longer than what is drawn
  EXPECT_FALSE(is_valid(bad));
  bad = good;
  bad.cell_size_m = 0.0;
  EXPECT_FALSE(is_valid(bad));
  bad = good;
  bad.origin_m[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_valid(bad));
}

TEST(Trail, KeepsPosesThatAreFarEnoughApart) {
  Trail trail("odom", 0.1);
  geometry::SE3 pose = geometry::SE3::Identity();
  EXPECT_TRUE(trail.add(time::from_utime(1), pose));
  pose.translation().x() = 0.09;
  EXPECT_FALSE(trail.add(time::from_utime(2), pose));
  pose.translation().x() = 0.11;
  EXPECT_TRUE(trail.add(time::from_utime(3), pose));
  const Json json = trail.poses_in_frame();
  EXPECT_EQ(json["poses"].size(), 2U);
  EXPECT_EQ(json["timestamp"], time_json(time::from_utime(3)));
}

TEST(Trail, IsToldWhenItHasGrownAndNotTooOften) {
  Trail trail("odom", 0.1);
  geometry::SE3 pose = geometry::SE3::Identity();
  trail.add(time::from_utime(0), pose);
  EXPECT_TRUE(trail.is_due(time::from_utime(0)));
  pose.translation().x() = 1.0;
  trail.add(time::from_utime(10), pose);
  EXPECT_FALSE(trail.is_due(time::Timestamp(Trail::kPeriod - 1us)));
  EXPECT_TRUE(trail.is_due(time::Timestamp(Trail::kPeriod)));
  EXPECT_FALSE(trail.is_due(time::Timestamp(5 * Trail::kPeriod)));
  pose.translation().x() = 2.0;
  trail.add(time::from_utime(20), pose);
  EXPECT_TRUE(trail.is_due(time::from_utime(20)));  // the clock was set back
}

TEST(Trail, ForgetsTheOldestWhenItIsFull) {
  Trail trail("odom", 0.5);
  geometry::SE3 pose = geometry::SE3::Identity();
  for (std::size_t i = 0; i < Trail::kMaxPoses + 3; ++i) {
    pose.translation().x() = static_cast<double>(i);
    trail.add(time::from_utime(static_cast<std::int64_t>(i)), pose);
  }
  EXPECT_EQ(trail.size(), Trail::kMaxPoses);
  EXPECT_DOUBLE_EQ(trail.poses_in_frame()["poses"][0]["position"]["x"], 3.0);
}

TEST(Scene, TheCorridorBeginsAtTheRobotsFront) {
  const Body body;
  const Json update = corridor_scene(foxglove::test::navigation_at(0.0), body);
  ASSERT_EQ(update["entities"].size(), 1U);
  const Json& cube = update["entities"][0]["cubes"][0];
  EXPECT_DOUBLE_EQ(cube["size"]["x"], 1.5);
  // Half the body, then half the corridor.
  EXPECT_DOUBLE_EQ(cube["pose"]["position"]["x"], 0.225 + 0.75);
  EXPECT_EQ(update["entities"][0]["texts"][0]["text"], "STEER");
}

TEST(JsonMessage, NamesConstantsAndWhatIsNone) {
  using Navigation = JsonMessage<nodmap::navigation_t>;
  EXPECT_STREQ(Navigation::constant_name(-1), "UNKNOWN");
  EXPECT_STREQ(Navigation::constant_name(5), "UNKNOWN");
  EXPECT_STREQ(Navigation::constant_name(nodmap::navigation_t::HALT), "HALT");
  nodmap::navigation_t message = foxglove::test::navigation_at(0.0);
  message.behaviour = nodmap::navigation_t::BRAKE;
  EXPECT_EQ(Navigation::fields(message)["behaviour_name"], "BRAKE");
}

TEST(JsonMessage, LeavesOutLongAndVariableArrays) {
  const Json odometry = JsonMessage<nodmap::odometry_t>::fields(foxglove::test::odometry_at(1.0));
  EXPECT_EQ(odometry["position_m"].size(), 3U);
  EXPECT_FALSE(odometry.contains("pose_covariance"));
  EXPECT_FALSE(JsonMessage<nodmap::truth_t>::fields(foxglove::test::truth_at(1.0))
                   .contains("actor_position_m"));
}

// From 0.4 m above the ground, 30 degrees down: the ray meets the ground after 0.8 m, 0.8 cos 30
// ahead.
TEST(Scene, TheAreaOfInterestEndsOnTheGround) {
  nodmap::pitch_command_t command{};
  command.pitch_min_rad = -std::numbers::pi / 6.0;
  command.pitch_max_rad = 0.0;
  const Json update = area_of_interest_scene(command, {0.1, 0.0, 0.4}, Body{});
  const Json& points = update["entities"][0]["lines"][0]["points"];
  EXPECT_NEAR(points[1]["x"], 0.1 + 0.8 * std::cos(std::numbers::pi / 6.0), 1e-12);
  EXPECT_NEAR(points[1]["z"], 0.0, 1e-12);
  EXPECT_NEAR(points[5]["x"], 3.1, 1e-12);
  EXPECT_NEAR(points[5]["z"], 0.4, 1e-12);
}

TEST(Scene, AnEndedGoalIsDeleted) {
  nodmap::goal_t goal = foxglove::test::goal();
  EXPECT_EQ(goal_scene(goal)["entities"][0]["id"], "goal");
  goal.is_active = 0;
  EXPECT_TRUE(goal_scene(goal)["entities"].empty());
  EXPECT_EQ(goal_scene(goal)["deletions"][0]["id"], "goal");
}

TEST(Scene, AGoalWithAHeadingPointsThere) {
  nodmap::goal_t goal = foxglove::test::goal();
  EXPECT_TRUE(goal_scene(goal)["entities"][0]["lines"].empty());
  goal.has_heading = 1;
  goal.heading_rad = 0.5 * std::numbers::pi;
  const Json update = goal_scene(goal);
  const Json& points = update["entities"][0]["lines"][0]["points"];
  EXPECT_NEAR(points[1]["x"].get<double>() - points[0]["x"].get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(points[1]["y"].get<double>() - points[0]["y"].get<double>(), 0.5, 1e-12);
}

TEST(Scene, APathGoesWithTheGoal) {
  nodmap::path_t path = foxglove::test::path();
  const Json entity = path_scene(path)["entities"][0];
  ASSERT_EQ(entity["lines"].size(), 2U);
  EXPECT_EQ(entity["lines"][0]["points"].size(), 3U);
  EXPECT_EQ(entity["lines"][0]["points"][2]["y"], 0.5);
  EXPECT_EQ(entity["lines"][1]["points"].size(), 2U);  // the arc
  path.state = nodmap::path_t::NO_GOAL;
  EXPECT_TRUE(path_scene(path)["entities"].empty());
  EXPECT_EQ(path_scene(path)["deletions"][0]["id"], "path");
}

TEST(Scene, EachTrackIsARingAndTheWayOfItsNextSecond) {
  nodmap::tracks_t tracks = foxglove::test::tracks();
  const Json entity = tracks_scene(tracks)["entities"][0];
  EXPECT_EQ(entity["frame_id"], "odom");
  ASSERT_EQ(entity["lines"].size(), 4U);
  for (const Json& p : entity["lines"][0]["points"]) {
    EXPECT_NEAR(std::hypot(p["x"].get<double>() - 2.0, p["y"].get<double>() - 1.0), 0.25, 1e-12);
  }
  EXPECT_EQ(entity["lines"][1]["points"][1]["x"], 1.0);
  EXPECT_EQ(entity["lines"][3]["points"][1]["y"], 0.5);
  EXPECT_LT(entity["lines"][2]["color"]["a"], entity["lines"][0]["color"]["a"]);  // out of sight
  tracks = {};
  EXPECT_TRUE(tracks_scene(tracks)["entities"].empty());
  EXPECT_EQ(tracks_scene(tracks)["deletions"][0]["id"], "tracks");
}

TEST(Scene, AnExplorationShowsFrontiersAndTourUntilItEnds) {
  nodmap::exploration_t exploration = foxglove::test::exploration();
  const Json entity = exploration_scene(exploration)["entities"][0];
  ASSERT_EQ(entity["lines"].size(), 2U);
  EXPECT_EQ(entity["lines"][0]["points"].size(), 2U);  // a stroke
  EXPECT_EQ(entity["lines"][1]["points"].size(), 5U);  // path, then the viewpoints
  EXPECT_EQ(entity["lines"][1]["points"][4]["x"], 5.0);
  EXPECT_EQ(entity["cylinders"].size(), 2U);
  EXPECT_EQ(entity["texts"][1]["text"], "2: 3.5 m2");
  exploration.state = nodmap::exploration_t::HOME;
  EXPECT_TRUE(exploration_scene(exploration)["entities"].empty());
  EXPECT_EQ(exploration_scene(exploration)["deletions"][0]["id"], "exploration");
}

TEST(Scene, ThePoseGraphShowsItsLoopsByWhatBecameOfThem) {
  const Json entity = pose_graph_scene(foxglove::test::pose_graph())["entities"][0];
  ASSERT_EQ(entity["lines"].size(), 3U);
  EXPECT_EQ(entity["lines"][0]["points"].size(), 3U);  // the submaps
  const Json& accepted = entity["lines"][1]["points"];
  ASSERT_EQ(accepted.size(), 2U);
  EXPECT_EQ(accepted[0]["x"], 0.0);
  EXPECT_EQ(accepted[1]["x"], 2.0);
  EXPECT_EQ(entity["lines"][2]["points"].size(), 2U);  // the one refused
}

TEST(Scene, ALoopBetweenSubmapsThatAreNotThereIsNotDrawn) {
  nodmap::pose_graph_t graph = foxglove::test::pose_graph();
  graph.from_submap[0] = -1;
  graph.to_submap[1] = 3;
  const Json entity = pose_graph_scene(graph)["entities"][0];
  EXPECT_TRUE(entity["lines"][1]["points"].empty());
  EXPECT_TRUE(entity["lines"][2]["points"].empty());
}

TEST(Scene, ThePoseGraphOf6dSlamShowsItsKeyframesInSpace) {
  const Json entity = pose_graph_6d_scene(foxglove::test::pose_graph_6d())["entities"][0];
  EXPECT_EQ(entity["frame_id"], "map_6d");
  EXPECT_EQ(entity["lines"][0]["points"][1]["x"], 3.0);
  EXPECT_EQ(entity["lines"][1]["points"].size(), 2U);
  EXPECT_TRUE(entity["lines"][2]["points"].empty());  // from a keyframe that is not there
}

/// Checks a value against a schema, for the part of JSON Schema that our schemas use. Empty if it
/// fits and no described property is missing.
std::string misfit(const Json& value, const Json& schema, const std::string& path = "$") {
  const Json& type = schema["type"];
  const auto is = [&value](const std::string& name) {
    return name == "object"    ? value.is_object()
           : name == "array"   ? value.is_array()
           : name == "string"  ? value.is_string()
           : name == "integer" ? value.is_number_integer()
           : name == "number"  ? value.is_number()
           : name == "boolean" ? value.is_boolean()
                               : value.is_null();
  };
  const bool fits = type.is_array() ? std::any_of(type.begin(), type.end(), is) : is(type);
  if (!fits) {
    return path + " is " + value.dump();
  }
  std::string found;
  if (value.is_object() && schema.contains("properties")) {
    for (const auto& [name, inner] : schema["properties"].items()) {
      found += value.contains(name) ? misfit(value[name], inner, path + "." + name)
                                    : path + "." + name + " is missing";
    }
    for (const auto& [name, unused] : value.items()) {
      found += schema["properties"].contains(name) ? "" : path + "." + name + " is not described";
    }
  }
  if (value.is_array()) {
    for (const Json& item : value) {
      found += misfit(item, schema["items"], path + "[]");
    }
  }
  return found;
}

TEST(Schemas, DescribeWhatIsSent) {
  const auto fits = [](const char* name, const Json& value) {
    const Json schema = Json::parse(schema_text(name));
    // As a reader receives it: values that JSON cannot express have become null.
    EXPECT_EQ(misfit(Json::parse(to_text(value)), schema), "") << name;
    EXPECT_EQ(schema["title"], name);
  };
  namespace robot = foxglove::test;
  const geometry::SE3 pose = geometry::SE3::Identity();
  Trail trail("odom", 0.1);
  trail.add(time::from_utime(0), pose);
  ProcessTable table;
  table.update(robot::status_at(0.0));
  fits("foxglove.LaserScan", laser_scan(level_scan()));
  fits("foxglove.PointCloud", egomap_cloud(robot::egomap_at(0.0), pose));
  fits("foxglove.Grid", grid({{}, 0.1, 0.0, 0.0, 1, 1, {0}}));
  fits("foxglove.Grid", local_map_grid(robot::local_map()));
  fits("foxglove.FrameTransform", frame_transform({}, "a", "b", pose));
  fits("foxglove.PosesInFrame", trail.poses_in_frame());
  fits("foxglove.SceneUpdate", body_scene({}, Body{}));
  fits("foxglove.SceneUpdate", corridor_scene(robot::navigation_at(0.0), Body{}));
  fits("foxglove.SceneUpdate",
       area_of_interest_scene(robot::pitch_command_at(0.0), {0, 0, 0.4}, Body{}));
  fits("foxglove.SceneUpdate", goal_scene(robot::goal()));
  fits("foxglove.SceneUpdate", goal_scene(nodmap::goal_t{}));
  fits("foxglove.SceneUpdate", path_scene(robot::path()));
  fits("foxglove.SceneUpdate", tracks_scene(robot::tracks()));
  fits("foxglove.SceneUpdate", tracks_scene(nodmap::tracks_t{}));
  fits("foxglove.SceneUpdate", exploration_scene(robot::exploration()));
  fits("foxglove.SceneUpdate", pose_graph_scene(robot::pose_graph()));
  fits("foxglove.SceneUpdate", pose_graph_6d_scene(robot::pose_graph_6d()));
  fits("foxglove.SceneUpdate", people_scene(robot::truth_at(0.0)));
  fits("foxglove.Log", health_log(robot::status_at(0.0)));
  fits("nodmap.processes", table.processes());
  const auto message_fits = [&fits]<class Message>(const Message& message) {
    fits(JsonMessage<Message>::kName, JsonMessage<Message>::fields(message));
  };
  message_fits(robot::base_sensors_at(0.0));
  message_fits(robot::drive_at(0.0));
  message_fits(robot::exploration());
  message_fits(robot::goal());
  message_fits(robot::navigation_at(0.0));
  message_fits(robot::odometry_at(0.0));
  message_fits(robot::pitch_command_at(0.0));
  message_fits(robot::pitch_state_at(0.0));
  message_fits(robot::pose_at(0.0));
  message_fits(robot::status_at(0.0));
  message_fits(robot::stop());
  message_fits(robot::truth_at(0.0));
}

}  // namespace views_test
}  // namespace nodmap::foxglove
