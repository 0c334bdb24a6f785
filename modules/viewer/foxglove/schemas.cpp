// SPDX-License-Identifier: BSD-3-Clause
// Foxglove's own schemas, those of the process tables and of the state of STOP. The schemas of our
// messages are generated.
#include <initializer_list>
#include <map>
#include <utility>

#include "modules/viewer/foxglove/foxglove.hpp"
#include "nodmap/json_messages.hpp"

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
// Schema of a number; null if it is not finite.
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

// Schemas of the process tables, which are STATUS and the commands of the process manager, and of
// the state of STOP.
std::map<std::string, Json> own_schemas() {
  Json process = Json::parse(json_message_schemas().at("nodmap.status_t"));
  process["properties"]["age_s"] = number();
  const Json host = object({{"host", text()},
                            {"cpu_share", number_or_null()},
                            {"memory_total_bytes", integer()},
                            {"memory_free_bytes", integer()},
                            {"age_s", number()}});
  const Json command = object({{"command", text()},
                               {"group", text()},
                               {"host", text()},
                               {"process_name", text()},
                               {"state", text()},
                               {"pid", integer()},
                               {"cpu_share", number_or_null()},
                               {"rss_bytes", integer()},
                               {"end", text()}});
  return {
      {"nodmap.processes",
       titled("nodmap.processes", {{"timestamp", time()}, {"processes", array_of(process)}})},
      {"nodmap.commands",
       titled("nodmap.commands",
              {{"timestamp", time()}, {"hosts", array_of(host)}, {"commands", array_of(command)}})},
      {"nodmap.stop_state",
       titled("nodmap.stop_state", {{"timestamp", time()}, {"state", text()}, {"by", text()}})}};
}

std::map<std::string, std::string> all_texts() {
  std::map<std::string, std::string> texts = json_message_schemas();
  for (const auto& group : {foxglove_schemas(), own_schemas()}) {
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
