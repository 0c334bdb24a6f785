// SPDX-License-Identifier: BSD-3-Clause
#include "common/foxglove/schemas.hpp"

#include <initializer_list>
#include <map>
#include <utility>

#include "common/foxglove/foxglove.hpp"

namespace nodmap::foxglove {
namespace {

using Properties = std::initializer_list<std::pair<const char*, Json>>;

Json type(const char* name) {
  return {{"type", name}};
}
Json number() {
  return type("number");
}
Json integer() {
  return type("integer");
}
Json text() {
  return type("string");
}
Json boolean() {
  return type("boolean");
}
/// A number, or null where it is not finite.
Json number_or_null() {
  return {{"type", Json::array({"number", "null"})}};
}
Json bytes() {
  return {{"type", "string"}, {"contentEncoding", "base64"}};
}
Json array_of(Json items) {
  return {{"type", "array"}, {"items", std::move(items)}};
}

Json object(Properties properties) {
  Json members = Json::object();
  for (const auto& [name, schema] : properties) {
    members[name] = schema;
  }
  return {{"type", "object"}, {"properties", std::move(members)}};
}

Json titled(const char* title, Properties properties) {
  Json schema = object(properties);
  schema["title"] = title;
  return schema;
}

Json time() {
  return object({{"sec", integer()}, {"nsec", integer()}});
}
Json vector2() {
  return object({{"x", number()}, {"y", number()}});
}
Json vector3() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}});
}
Json quaternion() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
Json pose() {
  return object({{"position", vector3()}, {"orientation", quaternion()}});
}
Json color() {
  return object({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}
Json packed_fields() {
  return array_of(object({{"name", text()}, {"offset", integer()}, {"type", integer()}}));
}

Json solid() {
  return object({{"pose", pose()}, {"size", vector3()}, {"color", color()}});
}

Json cylinder() {
  return object({{"pose", pose()},
                 {"size", vector3()},
                 {"bottom_scale", number()},
                 {"top_scale", number()},
                 {"color", color()}});
}

Json line() {
  return object({{"type", integer()},
                 {"pose", pose()},
                 {"thickness", number()},
                 {"scale_invariant", boolean()},
                 {"points", array_of(vector3())},
                 {"color", color()},
                 {"colors", array_of(color())},
                 {"indices", array_of(integer())}});
}

Json scene_text() {
  return object({{"pose", pose()},
                 {"billboard", boolean()},
                 {"font_size", number()},
                 {"scale_invariant", boolean()},
                 {"color", color()},
                 {"text", text()}});
}

Json scene_entity() {
  const Json unused = array_of(type("object"));
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"id", text()},
                 {"lifetime", time()},
                 {"frame_locked", boolean()},
                 {"metadata", array_of(object({{"key", text()}, {"value", text()}}))},
                 {"arrows", unused},
                 {"cubes", array_of(solid())},
                 {"spheres", array_of(solid())},
                 {"cylinders", array_of(cylinder())},
                 {"lines", array_of(line())},
                 {"triangles", unused},
                 {"texts", array_of(scene_text())},
                 {"models", unused}});
}

std::map<std::string, Json> foxglove_schemas() {
  return {
      {"foxglove.LaserScan", titled("foxglove.LaserScan", {{"timestamp", time()},
                                                           {"frame_id", text()},
                                                           {"pose", pose()},
                                                           {"start_angle", number()},
                                                           {"end_angle", number()},
                                                           {"ranges", array_of(number())},
                                                           {"intensities", array_of(number())}})},
      {"foxglove.PointCloud", titled("foxglove.PointCloud", {{"timestamp", time()},
                                                             {"frame_id", text()},
                                                             {"pose", pose()},
                                                             {"point_stride", integer()},
                                                             {"fields", packed_fields()},
                                                             {"data", bytes()}})},
      {"foxglove.Grid", titled("foxglove.Grid", {{"timestamp", time()},
                                                 {"frame_id", text()},
                                                 {"pose", pose()},
                                                 {"column_count", integer()},
                                                 {"cell_size", vector2()},
                                                 {"row_stride", integer()},
                                                 {"cell_stride", integer()},
                                                 {"fields", packed_fields()},
                                                 {"data", bytes()}})},
      {"foxglove.VoxelGrid", titled("foxglove.VoxelGrid", {{"timestamp", time()},
                                                           {"frame_id", text()},
                                                           {"pose", pose()},
                                                           {"row_count", integer()},
                                                           {"column_count", integer()},
                                                           {"cell_size", vector3()},
                                                           {"slice_stride", integer()},
                                                           {"row_stride", integer()},
                                                           {"cell_stride", integer()},
                                                           {"fields", packed_fields()},
                                                           {"data", bytes()}})},
      {"foxglove.FrameTransform", titled("foxglove.FrameTransform", {{"timestamp", time()},
                                                                     {"parent_frame_id", text()},
                                                                     {"child_frame_id", text()},
                                                                     {"translation", vector3()},
                                                                     {"rotation", quaternion()}})},
      {"foxglove.PosesInFrame",
       titled("foxglove.PosesInFrame",
              {{"timestamp", time()}, {"frame_id", text()}, {"poses", array_of(pose())}})},
      {"foxglove.SceneUpdate",
       titled("foxglove.SceneUpdate",
              {{"deletions",
                array_of(object({{"timestamp", time()}, {"type", integer()}, {"id", text()}}))},
               {"entities", array_of(scene_entity())}})},
      {"foxglove.Log", titled("foxglove.Log", {{"timestamp", time()},
                                               {"level", integer()},
                                               {"message", text()},
                                               {"name", text()},
                                               {"file", text()},
                                               {"line", integer()}})}};
}

std::map<std::string, Json> decision_schemas() {
  const Json n = number_or_null();
  const Json list = array_of(n);
  return {{"nodmap.drive_t", titled("nodmap.drive_t", {{"utime", integer()},
                                                       {"drive_seq", integer()},
                                                       {"forward_mps", n},
                                                       {"yaw_rate_rad_s", n},
                                                       {"valid_us", integer()}})},
          {"nodmap.goal_t", titled("nodmap.goal_t", {{"utime", integer()},
                                                     {"goal_seq", integer()},
                                                     {"is_active", boolean()},
                                                     {"position_m", list},
                                                     {"tolerance_m", n}})},
          {"nodmap.stop_t", titled("nodmap.stop_t", {{"utime", integer()},
                                                     {"stop_seq", integer()},
                                                     {"is_stopped", boolean()},
                                                     {"requested_by", text()}})},
          {"nodmap.navigation_t", titled("nodmap.navigation_t", {{"utime", integer()},
                                                                 {"drive_seq", integer()},
                                                                 {"behaviour", integer()},
                                                                 {"behaviour_name", text()},
                                                                 {"reason", text()},
                                                                 {"steering_angle_rad", n},
                                                                 {"corridor_length_m", n},
                                                                 {"corridor_width_m", n},
                                                                 {"free_way_m", n},
                                                                 {"max_forward_mps", n}})}};
}

Json process_status() {
  const Json n = number_or_null();
  return object({{"utime", integer()},
                 {"process_name", text()},
                 {"health", integer()},
                 {"health_reason", text()},
                 {"handled_per_s", n},
                 {"latency_p50_us", n},
                 {"latency_p99_us", n},
                 {"total_handled", integer()},
                 {"total_lost", integer()},
                 {"total_corrupt", integer()},
                 {"total_rejected", integer()}});
}

std::map<std::string, Json> state_schemas() {
  const Json n = number_or_null();
  const Json list = array_of(n);
  return {
      {"nodmap.odometry_t", titled("nodmap.odometry_t", {{"utime", integer()},
                                                         {"odometry_seq", integer()},
                                                         {"position_m", list},
                                                         {"orientation", list},
                                                         {"forward_mps", n},
                                                         {"yaw_rate_rad_s", n}})},
      {"nodmap.pitch_command_t", titled("nodmap.pitch_command_t", {{"utime", integer()},
                                                                   {"command_seq", integer()},
                                                                   {"pitch_min_rad", n},
                                                                   {"pitch_max_rad", n},
                                                                   {"sweep_s", n},
                                                                   {"max_forward_mps", n}})},
      {"nodmap.pitch_state_t", titled("nodmap.pitch_state_t", {{"utime", integer()},
                                                               {"state_seq", integer()},
                                                               {"pitch_rad", n},
                                                               {"pitch_rate_rad_s", n},
                                                               {"pitch_is_measured", boolean()},
                                                               {"goal_pitch_rad", n},
                                                               {"goal_speed_rad_s", n},
                                                               {"sweep_count", integer()},
                                                               {"is_stalled", boolean()}})},
      {"nodmap.pose_t", titled("nodmap.pose_t", {{"utime", integer()},
                                                 {"position_m", list},
                                                 {"orientation", list},
                                                 {"odom_position_m", list},
                                                 {"odom_orientation", list},
                                                 {"match_share", n},
                                                 {"match_rms_m", n},
                                                 {"pose_quality", integer()}})},
      {"nodmap.truth_t", titled("nodmap.truth_t", {{"utime", integer()},
                                                   {"truth_seq", integer()},
                                                   {"position_m", list},
                                                   {"orientation", list},
                                                   {"forward_mps", n},
                                                   {"yaw_rate_rad_s", n},
                                                   {"pitch_rad", n},
                                                   {"clearance_m", n},
                                                   {"collisions", integer()},
                                                   {"bumps", integer()}})},
      {"nodmap.base_sensors_t", titled("nodmap.base_sensors_t", {{"utime", integer()},
                                                                 {"sensors_seq", integer()},
                                                                 {"infrared_m", list},
                                                                 {"sonar_m", n},
                                                                 {"roll_rad", n},
                                                                 {"pitch_rad", n},
                                                                 {"gyro_yaw_rad", n},
                                                                 {"motor_current_left_a", n},
                                                                 {"motor_current_right_a", n}})},
      {"nodmap.processes",
       titled("nodmap.processes",
              {{"timestamp", time()}, {"processes", array_of(process_status())}})}};
}

std::map<std::string, Json> process_manager_schemas() {
  const Json host = object({{"host", text()},
                            {"cpu_share", number_or_null()},
                            {"memory_total_bytes", integer()},
                            {"memory_free_bytes", integer()}});
  const Json command = object({{"command", text()},
                               {"group", text()},
                               {"host", text()},
                               {"process_name", text()},
                               {"state", text()},
                               {"pid", integer()},
                               {"cpu_share", number_or_null()},
                               {"rss_bytes", integer()},
                               {"end", text()}});
  return {{"nodmap.commands", titled("nodmap.commands", {{"timestamp", time()},
                                                         {"hosts", array_of(host)},
                                                         {"commands", array_of(command)}})}};
}

std::map<std::string, std::string> all_texts() {
  std::map<std::string, std::string> texts;
  for (const auto& group :
       {foxglove_schemas(), decision_schemas(), state_schemas(), process_manager_schemas()}) {
    for (const auto& [name, schema] : group) {
      texts.emplace(name, to_text(schema));
    }
  }
  return texts;
}

}  // namespace

const std::string& schema_text(const std::string& schema_name) {
  static const std::map<std::string, std::string> kTexts = all_texts();
  return kTexts.at(schema_name);
}

}  // namespace nodmap::foxglove
