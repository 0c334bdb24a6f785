// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/scene_views.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/node/messages.hpp"
#include "nodmap/json_messages.hpp"

namespace nodmap::foxglove {
namespace {

constexpr Color kBodyColor{0.95, 0.55, 0.1, 1.0};
constexpr Color kPersonColor{0.85, 0.2, 0.6, 0.9};
constexpr Color kGoalColor{0.1, 0.8, 0.3, 0.7};
constexpr Color kPathColor{0.1, 0.8, 0.3, 0.9};
constexpr Color kArcColor{1.0, 0.85, 0.2, 1.0};
constexpr Color kTextColor{1.0, 1.0, 1.0, 1.0};
constexpr Color kAreaColor{0.3, 0.7, 1.0, 0.8};
constexpr Color kTrackColor{1.0, 0.55, 0.1, 1.0};
constexpr Color kGuessedTrackColor{1.0, 0.55, 0.1, 0.45};
constexpr Color kFrontierColor{1.0, 0.3, 0.9, 0.9};
constexpr Color kTourColor{0.75, 0.55, 1.0, 0.9};
constexpr Color kGraphColor{0.37, 0.7, 1.0, 0.8};
constexpr Color kLoopColor{0.4, 0.9, 0.5, 0.8};
constexpr Color kRefusedLoopColor{0.9, 0.4, 0.2, 0.5};
constexpr int kLineStrip = 0;
constexpr int kLineList = 2;

geometry::SE3 at(double x_m, double y_m, double z_m) {
  geometry::SE3 pose = geometry::SE3::Identity();
  pose.translation() = Eigen::Vector3d(x_m, y_m, z_m);
  return pose;
}

// An entity without primitives; it stays until it is replaced.
Json entity(time::Timestamp stamp, const char* frame_id, const std::string& id) {
  Json json = {{"timestamp", time_json(stamp)},
               {"frame_id", frame_id},
               {"id", id},
               {"lifetime", {{"sec", 0}, {"nsec", 0}}},
               {"frame_locked", true}};
  for (const char* list : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                           "triangles", "texts", "models"}) {
    json[list] = Json::array();
  }
  return json;
}

Json update(Json entities, Json deletions = Json::array()) {
  return {{"deletions", std::move(deletions)}, {"entities", std::move(entities)}};
}

Json one(Json single) {
  return update(Json::array({std::move(single)}));
}

Json deletion(time::Timestamp stamp, const std::string& id) {
  return {{"timestamp", time_json(stamp)}, {"type", 0}, {"id", id}};
}

Json solid(const geometry::SE3& pose, const Eigen::Vector3d& size_m, const Color& color) {
  return {{"pose", pose_json(pose)}, {"size", vector_json(size_m)}, {"color", color_json(color)}};
}

Json cylinder(const geometry::SE3& pose, double radius_m, double height_m, const Color& color) {
  Json json = solid(pose, {2.0 * radius_m, 2.0 * radius_m, height_m}, color);
  json["bottom_scale"] = 1.0;
  json["top_scale"] = 1.0;
  return json;
}

Json lines(int type, const std::vector<Eigen::Vector3d>& points, const Color& color) {
  Json list = Json::array();
  for (const Eigen::Vector3d& p : points) {
    list.push_back(vector_json(p));
  }
  return {{"type", type},
          {"pose", pose_json(geometry::SE3::Identity())},
          {"thickness", 2.0},
          {"scale_invariant", true},
          {"points", list},
          {"color", color_json(color)},
          {"colors", Json::array()},
          {"indices", Json::array()}};
}

Json text(const geometry::SE3& pose, const std::string& words, const Color& color) {
  return {{"pose", pose_json(pose)}, {"billboard", true},          {"font_size", 14.0},
          {"scale_invariant", true}, {"color", color_json(color)}, {"text", words}};
}

Color behaviour_color(std::int8_t behaviour) {
  switch (behaviour) {
    case nodmap::navigation_t::STEER:
      return {0.1, 0.7, 0.3, 0.25};
    case nodmap::navigation_t::BRAKE:
      return {0.9, 0.7, 0.1, 0.3};
    case nodmap::navigation_t::TURN:
      return {0.2, 0.5, 0.9, 0.3};
    case nodmap::navigation_t::ARRIVED:
      return {0.6, 0.6, 0.6, 0.3};
    default:
      return {0.9, 0.2, 0.2, 0.35};
  }
}

// Lines of a pose graph: the nodes in order, accepted loop closures (state 0), and rejected ones.
Json graph_lines(const std::vector<Eigen::Vector3d>& nodes, const std::vector<std::int32_t>& from,
                 const std::vector<std::int32_t>& to, const std::vector<std::int8_t>& state) {
  static_assert(nodmap::pose_graph_t::ACCEPTED == 0 && nodmap::pose_graph_6d_t::ACCEPTED == 0);
  std::vector<Eigen::Vector3d> accepted;
  std::vector<Eigen::Vector3d> refused;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto a = static_cast<std::size_t>(from[i]);
    const auto b = static_cast<std::size_t>(to[i]);
    if (a >= nodes.size() || b >= nodes.size()) {
      continue;  // also catches negative numbers
    }
    auto& ends = state[i] == nodmap::pose_graph_t::ACCEPTED ? accepted : refused;
    ends.push_back(nodes[a]);
    ends.push_back(nodes[b]);
  }
  return Json::array({lines(kLineStrip, nodes, kGraphColor), lines(kLineList, accepted, kLoopColor),
                      lines(kLineList, refused, kRefusedLoopColor)});
}

}  // namespace

Json body_scene(time::Timestamp stamp, const robot::Body& body) {
  Json robot = entity(stamp, frames::kBase, "robot");
  // The chassis, and on it the narrower scanner at the front.
  const double chassis_m = 0.6 * body.height_m;
  const double scanner_m = body.height_m - chassis_m;
  robot["cubes"] = Json::array(
      {solid(at(0.0, 0.0, 0.5 * chassis_m), {body.length_m, body.width_m, chassis_m}, kBodyColor),
       solid(at(0.3 * body.length_m, 0.0, chassis_m + 0.5 * scanner_m),
             {0.35 * body.length_m, 0.5 * body.width_m, scanner_m}, {0.2, 0.3, 0.6, 1.0})});
  return one(std::move(robot));
}

Json corridor_scene(const nodmap::navigation_t& navigation, const robot::Body& body) {
  const double length_m = std::max(navigation.corridor_length_m, 0.0);
  const double front_m = 0.5 * body.length_m;
  const Color color = behaviour_color(navigation.behaviour);
  Json corridor = entity(time::from_utime(navigation.utime), frames::kBase, "corridor");
  corridor["cubes"] =
      Json::array({solid(at(front_m + 0.5 * length_m, 0.0, 0.5 * body.height_m),
                         {length_m, navigation.corridor_width_m, body.height_m}, color)});
  const double reach_m = 1.0;
  corridor["lines"] =
      Json::array({lines(kLineStrip,
                         {{front_m, 0.0, 0.02},
                          {front_m + reach_m * std::cos(navigation.steering_angle_rad),
                           reach_m * std::sin(navigation.steering_angle_rad), 0.02}},
                         {color.r, color.g, color.b, 1.0})});
  std::string words = JsonMessage<nodmap::navigation_t>::constant_name(navigation.behaviour);
  words += navigation.reason.empty() ? "" : ": " + navigation.reason;
  corridor["texts"] = Json::array({text(at(0.0, 0.0, body.height_m + 0.25), words, kTextColor)});
  return one(std::move(corridor));
}

Json area_of_interest_scene(const nodmap::pitch_command_t& command,
                            const Eigen::Vector3d& p_base_mount, const robot::Body& body) {
  constexpr double kReachM = 3.0;
  std::vector<Eigen::Vector3d> points;
  for (const double pitch_rad : {command.pitch_min_rad, command.pitch_max_rad}) {
    const double down = -std::sin(pitch_rad);
    const double range_m =
        down > 0.0 ? std::min(kReachM, std::max(p_base_mount.z(), 0.0) / down) : kReachM;
    for (const double y_m : {-0.5 * body.width_m, 0.5 * body.width_m}) {
      points.emplace_back(p_base_mount.x(), y_m, p_base_mount.z());
      points.emplace_back(p_base_mount.x() + range_m * std::cos(pitch_rad), y_m,
                          p_base_mount.z() - range_m * down);
    }
  }
  Json area = entity(time::from_utime(command.utime), frames::kBase, "area_of_interest");
  area["lines"] =
      Json::array({lines(kLineList,
                         {points[0], points[1], points[2], points[3], points[4], points[5],
                          points[6], points[7], points[1], points[3], points[5], points[7]},
                         kAreaColor)});
  return one(std::move(area));
}

Json goal_scene(const nodmap::goal_t& goal) {
  if (goal.is_active == 0) {
    return update(Json::array(), Json::array({deletion(time::from_utime(goal.utime), "goal")}));
  }
  Json json = entity(time::from_utime(goal.utime), frames::kMap, "goal");
  const geometry::SE3 pose = at(goal.position_m[0], goal.position_m[1], 0.05);
  json["cylinders"] =
      Json::array({cylinder(pose, std::max(goal.tolerance_m, 0.05), 0.1, kGoalColor)});
  json["texts"] =
      Json::array({text(at(goal.position_m[0], goal.position_m[1], 0.4), "goal", kTextColor)});
  if (goal.has_heading != 0) {
    constexpr double kPointerM = 0.5;
    const Eigen::Vector3d pointer(std::cos(goal.heading_rad), std::sin(goal.heading_rad), 0.0);
    json["lines"] = Json::array({lines(
        kLineStrip, {pose.translation(), pose.translation() + kPointerM * pointer}, kGoalColor)});
  }
  return one(std::move(json));
}

Json path_scene(const nodmap::path_t& path) {
  if (path.state == nodmap::path_t::NO_GOAL) {
    return update(Json::array(), Json::array({deletion(time::from_utime(path.utime), "path")}));
  }
  static constexpr double kHeightM = 0.04;
  const auto points = [](const std::vector<double>& x_m, const std::vector<double>& y_m) {
    std::vector<Eigen::Vector3d> all;
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      all.emplace_back(x_m[i], y_m[i], kHeightM);
    }
    return all;
  };
  Json json = entity(time::from_utime(path.utime), frames::kOdom, "path");
  json["lines"] = Json::array({lines(kLineStrip, points(path.x_m, path.y_m), kPathColor),
                               lines(kLineStrip, points(path.arc_x_m, path.arc_y_m), kArcColor)});
  return one(std::move(json));
}

Json tracks_scene(const nodmap::tracks_t& tracks) {
  const time::Timestamp stamp = time::from_utime(tracks.utime);
  if (tracks.num_tracks == 0) {
    return update(Json::array(), Json::array({deletion(stamp, "tracks")}));
  }
  static constexpr double kHeightM = 0.06;
  static constexpr double kAheadS = 1.0;
  static constexpr int kCorners = 16;
  Json json = entity(stamp, frames::kOdom, "tracks");
  for (std::size_t i = 0; i < tracks.position_m.size(); ++i) {
    const Eigen::Vector3d center(tracks.position_m[i][0], tracks.position_m[i][1], kHeightM);
    const Eigen::Vector3d velocity(tracks.velocity_mps[i][0], tracks.velocity_mps[i][1], 0.0);
    const Color& color =
        tracks.state[i] == nodmap::tracks_t::WALKS ? kTrackColor : kGuessedTrackColor;
    std::vector<Eigen::Vector3d> ring;
    for (int corner = 0; corner <= kCorners; ++corner) {
      const double angle_rad = 2.0 * geometry::kPi * corner / kCorners;
      ring.emplace_back(center + tracks.radius_m[i] * Eigen::Vector3d(std::cos(angle_rad),
                                                                      std::sin(angle_rad), 0.0));
    }
    json["lines"].push_back(lines(kLineStrip, ring, color));
    json["lines"].push_back(lines(kLineStrip, {center, center + kAheadS * velocity}, color));
  }
  return one(std::move(json));
}

Json exploration_scene(const nodmap::exploration_t& exploration) {
  if (exploration.state == nodmap::exploration_t::IDLE ||
      exploration.state == nodmap::exploration_t::HOME) {
    return update(Json::array(),
                  Json::array({deletion(time::from_utime(exploration.utime), "exploration")}));
  }
  static constexpr double kHeightM = 0.05;
  // A short vertical line for each frontier cell.
  static constexpr double kStrokeM = 0.15;
  std::vector<Eigen::Vector3d> frontier;
  for (std::size_t i = 0; i < exploration.frontier_x_m.size(); ++i) {
    const Eigen::Vector2d p(exploration.frontier_x_m[i], exploration.frontier_y_m[i]);
    frontier.emplace_back(p.x(), p.y(), kHeightM);
    frontier.emplace_back(p.x(), p.y(), kHeightM + kStrokeM);
  }
  std::vector<Eigen::Vector3d> path;
  for (std::size_t i = 0; i < exploration.x_m.size(); ++i) {
    path.emplace_back(exploration.x_m[i], exploration.y_m[i], kHeightM);
  }
  Json json = entity(time::from_utime(exploration.utime), frames::kMap, "exploration");
  for (std::size_t i = 0; i < exploration.viewpoint_x_m.size(); ++i) {
    const double x_m = exploration.viewpoint_x_m[i];
    const double y_m = exploration.viewpoint_y_m[i];
    path.emplace_back(x_m, y_m, kHeightM);
    const std::string words = fmt::format("{}: {:.1f} m2", i + 1, exploration.gain_m2[i]);
    json["cylinders"].push_back(cylinder(at(x_m, y_m, kHeightM), 0.1, 0.1, kTourColor));
    json["texts"].push_back(text(at(x_m, y_m, 0.4), words, kTextColor));
  }
  json["lines"] = Json::array(
      {lines(kLineList, frontier, kFrontierColor), lines(kLineStrip, path, kTourColor)});
  return one(std::move(json));
}

Json pose_graph_scene(const nodmap::pose_graph_t& graph) {
  constexpr double kHeightM = 0.03;
  std::vector<Eigen::Vector3d> submaps;
  for (std::size_t i = 0; i < graph.x_m.size(); ++i) {
    submaps.emplace_back(graph.x_m[i], graph.y_m[i], kHeightM);
  }
  Json json = entity(time::from_utime(graph.utime), frames::kMap, "pose_graph");
  json["lines"] = graph_lines(submaps, graph.from_submap, graph.to_submap, graph.loop_state);
  return one(std::move(json));
}

std::map<time::Timestamp, geometry::SE3> keyframe_poses(const nodmap::pose_graph_6d_t& graph) {
  std::map<time::Timestamp, geometry::SE3> T_map_base;
  for (std::size_t i = 0; i < graph.keyframe_utime.size(); ++i) {
    const std::vector<double>& p = graph.position_m[i];
    const std::vector<double> q(graph.orientation[i].begin(), graph.orientation[i].end());
    if (const auto pose = node::read_pose({p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]})) {
      T_map_base[time::from_utime(graph.keyframe_utime[i])] = *pose;
    }
  }
  return T_map_base;
}

Json pose_graph_6d_scene(const nodmap::pose_graph_6d_t& graph) {
  std::vector<Eigen::Vector3d> keyframes;
  for (const std::vector<double>& p : graph.position_m) {
    keyframes.emplace_back(p[0], p[1], p[2] + 0.03);
  }
  Json json = entity(time::from_utime(graph.utime), frames::kMap6d, "pose_graph_6d");
  json["lines"] = graph_lines(keyframes, graph.from_keyframe, graph.to_keyframe, graph.loop_state);
  return one(std::move(json));
}

Json people_scene(const nodmap::truth_t& truth) {
  Json people = entity(time::from_utime(truth.utime), frames::kWorld, "people");
  for (std::size_t i = 0; i < truth.actor_position_m.size(); ++i) {
    const std::vector<double>& p = truth.actor_position_m[i];
    people["cylinders"].push_back(cylinder(at(p[0], p[1], 0.5 * truth.actor_height_m[i]),
                                           truth.actor_radius_m[i], truth.actor_height_m[i],
                                           kPersonColor));
  }
  return one(std::move(people));
}

}  // namespace nodmap::foxglove
