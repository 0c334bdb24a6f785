// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/world_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "common/formats/input_file.hpp"
#include "common/formats/ply.hpp"
#include "common/formats/yaml_file.hpp"
#include "common/geometry/angle.hpp"

namespace nodmap::sim {
namespace {

using geometry::deg_to_rad;

// Reads values, and reports errors with their line.
class Reader {
 public:
  explicit Reader(std::filesystem::path file) : file_(std::move(file)) {}

  [[nodiscard]] World read_world() const;

 private:
  [[noreturn]] void fail(const YAML::Node& node, const std::string& what) const {
    throw formats::InputFileError(file_.string() + ":" +
                                  std::to_string(std::max(node.Mark().line, 0) + 1) + ": " + what);
  }

  void check_keys(const YAML::Node& map, std::string_view what,
                  std::initializer_list<std::string_view> known) const;
  [[nodiscard]] YAML::Node need(const YAML::Node& map, const std::string& key) const;
  [[nodiscard]] YAML::Node list(const YAML::Node& root, const std::string& key) const;
  [[nodiscard]] double number(const YAML::Node& node, const std::string& key) const;
  [[nodiscard]] double number_or(const YAML::Node& map, const std::string& key,
                                 double otherwise) const;
  // Reads a flag; false if it is missing.
  [[nodiscard]] bool flag(const YAML::Node& map, const std::string& key) const;
  [[nodiscard]] double positive(const YAML::Node& map, const std::string& key) const;
  [[nodiscard]] double reflectivity(const YAML::Node& map, const std::string& key) const;
  template <int n>
  [[nodiscard]] Eigen::Matrix<double, n, 1> vector(const YAML::Node& node,
                                                   const std::string& key) const;
  template <int n>
  [[nodiscard]] Eigen::Matrix<double, n, 1> vector_of(const YAML::Node& map,
                                                      const std::string& key) const {
    return vector<n>(need(map, key), key);
  }

  [[nodiscard]] Object read_object(const YAML::Node& item) const;
  [[nodiscard]] Box read_box(const YAML::Node& map) const;
  [[nodiscard]] Cylinder read_cylinder(const YAML::Node& map) const;
  [[nodiscard]] Box read_wall(const YAML::Node& map) const;
  [[nodiscard]] Ramp read_ramp(const YAML::Node& map) const;
  [[nodiscard]] Mesh load_mesh(const YAML::Node& map) const;
  [[nodiscard]] Pit read_pit(const YAML::Node& map) const;
  [[nodiscard]] Actor read_actor(const YAML::Node& map) const;
  [[nodiscard]] std::vector<Waypoint> read_path(const YAML::Node& path) const;

  std::filesystem::path file_;
};

void Reader::check_keys(const YAML::Node& map, std::string_view what,
                        std::initializer_list<std::string_view> known) const {
  if (!map.IsMap()) {
    fail(map, std::string(what) + ": expected {key: value, ...}");
  }
  for (const auto& item : map) {
    const std::string key = item.first.IsScalar() ? item.first.Scalar() : "";
    if (std::ranges::find(known, key) == known.end()) {
      fail(item.first, "unknown key '" + key + "' in " + std::string(what));
    }
    if (std::ranges::count_if(map, [&](const auto& other) {
          return other.first.IsScalar() && other.first.Scalar() == key;
        }) > 1) {
      fail(item.first, "key '" + key + "' is given twice");
    }
  }
}

YAML::Node Reader::need(const YAML::Node& map, const std::string& key) const {
  const YAML::Node node = map[key];
  if (!node) {
    fail(map, "missing key '" + key + "'");
  }
  return node;
}

// The items under a key; none if it is missing.
YAML::Node Reader::list(const YAML::Node& root, const std::string& key) const {
  const YAML::Node node = root[key];
  if (!node || node.IsNull()) {
    return YAML::Node(YAML::NodeType::Sequence);
  }
  if (!node.IsSequence()) {
    fail(node, "'" + key + "': expected a list");
  }
  return node;
}

double Reader::number(const YAML::Node& node, const std::string& key) const {
  double value = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value)) {
    fail(node, "'" + key + "': expected a number");
  }
  if (!std::isfinite(value)) {
    fail(node, "'" + key + "': the number is not finite");
  }
  if (std::abs(value) > kMaxWorldNumber) {
    fail(node, "'" + key + "': the number is beyond 1e5");
  }
  return value;
}

double Reader::number_or(const YAML::Node& map, const std::string& key, double otherwise) const {
  return map[key] ? number(map[key], key) : otherwise;
}

bool Reader::flag(const YAML::Node& map, const std::string& key) const {
  bool value = false;
  if (map[key] && !YAML::convert<bool>::decode(map[key], value)) {
    fail(map[key], "'" + key + "': expected true or false");
  }
  return value;
}

double Reader::positive(const YAML::Node& map, const std::string& key) const {
  const YAML::Node node = need(map, key);
  const double value = number(node, key);
  if (value <= 0.0) {
    fail(node, "'" + key + "': must be greater than 0");
  }
  return value;
}

double Reader::reflectivity(const YAML::Node& map, const std::string& key) const {
  const double value = number_or(map, key, kDefaultReflectivity);
  if (value < 0.0) {
    fail(map[key], "'" + key + "': must not be negative");
  }
  return value;
}

template <int n>
Eigen::Matrix<double, n, 1> Reader::vector(const YAML::Node& node, const std::string& key) const {
  if (!node.IsSequence() || node.size() != n) {
    fail(node, "'" + key + "': expected " + std::to_string(n) + " numbers");
  }
  Eigen::Matrix<double, n, 1> values;
  for (int i = 0; i < n; ++i) {
    values[i] = number(node[i], key);
  }
  return values;
}

Object Reader::read_object(const YAML::Node& item) const {
  if (!item.IsMap() || item.size() != 1) {
    fail(item, "expected one of box, cylinder, wall, ramp, mesh");
  }
  const auto kind = item.begin()->first.as<std::string>("");
  const YAML::Node map = item.begin()->second;
  if (!map.IsMap()) {
    fail(item, "'" + kind + "': expected {key: value, ...}");
  }
  Object object;
  if (kind == "box") {
    object.shape = read_box(map);
  } else if (kind == "cylinder") {
    object.shape = read_cylinder(map);
  } else if (kind == "wall") {
    object.shape = read_wall(map);
  } else if (kind == "ramp") {
    object.shape = read_ramp(map);
  } else if (kind == "mesh") {
    object.shape = load_mesh(map);
  } else {
    fail(item, "unknown object '" + kind + "'; known are box, cylinder, wall, ramp, mesh");
  }
  object.reflectivity = reflectivity(map, "reflectivity");
  return object;
}

Box Reader::read_box(const YAML::Node& map) const {
  check_keys(map, "box", {"center", "size", "yaw_deg", "reflectivity"});
  Box box{vector_of<3>(map, "center"), vector_of<3>(map, "size"),
          deg_to_rad(number_or(map, "yaw_deg", 0.0))};
  if (box.size.minCoeff() <= 0.0) {
    fail(map["size"], "'size': must be greater than 0");
  }
  return box;
}

Cylinder Reader::read_cylinder(const YAML::Node& map) const {
  check_keys(map, "cylinder", {"center", "radius", "height", "reflectivity"});
  return {vector_of<3>(map, "center"), positive(map, "radius"), positive(map, "height")};
}

// An upright plate between two points, as a box.
Box Reader::read_wall(const YAML::Node& map) const {
  check_keys(map, "wall", {"from", "to", "z", "thickness", "reflectivity"});
  const Eigen::Vector2d from = vector_of<2>(map, "from");
  const Eigen::Vector2d to = vector_of<2>(map, "to");
  const Eigen::Vector2d z = vector_of<2>(map, "z");
  const double thickness = positive(map, "thickness");
  const Eigen::Vector2d along = to - from;
  if (along.norm() <= 0.0) {
    fail(map, "a wall without length");
  }
  if (z.y() <= z.x()) {
    fail(map["z"], "'z': the top must be above the bottom");
  }
  const Eigen::Vector2d middle = 0.5 * (from + to);
  return {{middle.x(), middle.y(), 0.5 * (z.x() + z.y())},
          {along.norm(), thickness, z.y() - z.x()},
          std::atan2(along.y(), along.x())};
}

Ramp Reader::read_ramp(const YAML::Node& map) const {
  check_keys(map, "ramp", {"from", "to", "width", "reflectivity"});
  Ramp ramp{vector_of<3>(map, "from"), vector_of<3>(map, "to"), positive(map, "width")};
  if ((ramp.to - ramp.from).head<2>().norm() <= 0.0) {
    fail(map, "a ramp without length over ground");
  }
  return ramp;
}

Mesh Reader::load_mesh(const YAML::Node& map) const {
  check_keys(map, "mesh", {"file", "position", "yaw_deg", "reflectivity"});
  const YAML::Node name = need(map, "file");
  if (!name.IsScalar() || name.Scalar().empty()) {
    fail(name, "'file': expected the name of a PLY file");
  }
  const Eigen::Vector3d position = vector_of<3>(map, "position");
  const geometry::SE2 turn{0.0, 0.0, deg_to_rad(number_or(map, "yaw_deg", 0.0))};
  try {
    formats::TriangleMesh mesh = formats::read_ply_mesh(file_.parent_path() / name.Scalar());
    for (Eigen::Vector3d& vertex : mesh.vertices) {
      vertex.head<2>() = turn * Eigen::Vector2d(vertex.head<2>());
      vertex += position;
    }
    return {std::move(mesh.vertices), std::move(mesh.triangles)};
  } catch (const std::runtime_error& error) {
    fail(name, error.what());
  }
}

Pit Reader::read_pit(const YAML::Node& map) const {
  check_keys(map, "pit", {"min", "max", "depth"});
  Pit pit{vector_of<2>(map, "min"), vector_of<2>(map, "max"), positive(map, "depth")};
  if ((pit.max - pit.min).minCoeff() <= 0.0) {
    fail(map, "a pit whose max is not beyond its min");
  }
  return pit;
}

Actor Reader::read_actor(const YAML::Node& map) const {
  check_keys(
      map, "actor",
      {"cylinder", "path", "loop", "reacts", "legs", "reflectivity", "appear_s", "vanish_s"});
  Actor actor;
  const YAML::Node cylinder = need(map, "cylinder");
  check_keys(cylinder, "cylinder", {"radius", "height"});
  actor.radius_m = positive(cylinder, "radius");
  actor.height_m = positive(cylinder, "height");
  actor.path = read_path(need(map, "path"));
  actor.loop = flag(map, "loop");
  actor.reacts = flag(map, "reacts");
  actor.has_legs = flag(map, "legs");
  actor.reflectivity = reflectivity(map, "reflectivity");
  actor.appear_s = number_or(map, "appear_s", actor.appear_s);
  actor.vanish_s = number_or(map, "vanish_s", actor.vanish_s);
  if (actor.vanish_s <= actor.appear_s) {
    fail(map["vanish_s"], "'vanish_s': must be after 'appear_s'");
  }
  return actor;
}

std::vector<Waypoint> Reader::read_path(const YAML::Node& path) const {
  if (!path.IsSequence() || path.size() == 0) {
    fail(path, "'path': expected at least one waypoint [t_s, x, y]");
  }
  std::vector<Waypoint> waypoints;
  for (const YAML::Node& item : path) {
    const Eigen::Vector3d values = vector<3>(item, "path");
    if (!waypoints.empty() && values[0] <= waypoints.back().time_s) {
      fail(item, "'path': times must ascend");
    }
    waypoints.push_back({values[0], values.tail<2>()});
  }
  return waypoints;
}

World Reader::read_world() const {
  const YAML::Node root = formats::read_yaml(file_);
  check_keys(root, "world",
             {"name", "objects", "pits", "floor_reflectivity", "actors", "robot", "goal", "goals",
              "goal_heading"});
  World world;
  const YAML::Node name = need(root, "name");
  if (!name.IsScalar()) {
    fail(name, "'name': expected a text");
  }
  world.name = name.Scalar();
  for (const YAML::Node& item : list(root, "objects")) {
    world.objects.push_back(read_object(item));
  }
  for (const YAML::Node& item : list(root, "pits")) {
    world.pits.push_back(read_pit(item));
  }
  world.floor_reflectivity = reflectivity(root, "floor_reflectivity");
  for (const YAML::Node& item : list(root, "actors")) {
    world.actors.push_back(read_actor(item));
  }
  const YAML::Node robot = need(root, "robot");
  check_keys(robot, "robot", {"start"});
  const Eigen::Vector3d start = vector_of<3>(robot, "start");
  world.T_world_start = {start.x(), start.y(), geometry::normalize_angle(deg_to_rad(start.z()))};
  if (root["goal"]) {
    if (root["goals"]) {
      fail(root["goals"], "'goals': there is a 'goal' already");
    }
    world.goals.push_back(vector_of<2>(root, "goal"));
  }
  for (const YAML::Node& item : list(root, "goals")) {
    world.goals.push_back(vector<2>(item, "goals"));
  }
  if (root["goal_heading"]) {
    if (world.goals.empty()) {
      fail(root["goal_heading"], "'goal_heading': there is no goal");
    }
    world.goal_heading_rad = deg_to_rad(number(root["goal_heading"], "goal_heading"));
  }
  return world;
}

}  // namespace

World load_world(const std::filesystem::path& file) {
  return Reader(file).read_world();
}

}  // namespace nodmap::sim
