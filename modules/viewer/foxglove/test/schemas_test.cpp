// SPDX-License-Identifier: BSD-3-Clause
// Tests that the schemas describe what is sent, and that messages are converted to JSON correctly.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/node/messages.hpp"
#include "modules/viewer/foxglove/pose_views.hpp"
#include "modules/viewer/foxglove/process_tables.hpp"
#include "modules/viewer/foxglove/scene_views.hpp"
#include "modules/viewer/foxglove/sensor_views.hpp"
#include "modules/viewer/foxglove/stop_state.hpp"
#include "modules/viewer/foxglove/test/robot_maps.hpp"
#include "modules/viewer/foxglove/test/robot_messages.hpp"
#include "nodmap/json_messages.hpp"

namespace nodmap::foxglove {
namespace schemas_test {

TEST(JsonMessage, NamesConstantsAndUnknownValues) {
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

// Compares a value with a schema, for the part of JSON Schema that our schemas use. Empty if it
// fits and every property is described.
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

TEST(Schemas, DescribeTheMessagesThatAreSent) {
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
  table.update(robot::status_at(0.0), {});
  scan::Scan scan;
  ASSERT_TRUE(node::read_scan(robot::scan_at(0.0), scan));
  fits("foxglove.LaserScan", laser_scan(scan));
  fits("foxglove.PointCloud", egomap_cloud(robot::egomap_at(0.0), pose));
  fits("foxglove.Grid", grid({{}, 0.1, 0.0, 0.0, 1, 1, {0}}));
  fits("foxglove.Grid", local_map_grid(robot::local_map()));
  fits("foxglove.FrameTransform", frame_transform({}, "a", "b", pose));
  fits("foxglove.PosesInFrame", trail.poses_in_frame());
  fits("foxglove.SceneUpdate", body_scene({}, nodmap::robot::Body{}));
  fits("foxglove.SceneUpdate", corridor_scene(robot::navigation_at(0.0), nodmap::robot::Body{}));
  fits("foxglove.SceneUpdate",
       area_of_interest_scene(robot::pitch_command_at(0.0), {0, 0, 0.4}, nodmap::robot::Body{}));
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
  fits("nodmap.stop_state", StopState().to_json());
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

}  // namespace schemas_test
}  // namespace nodmap::foxglove
