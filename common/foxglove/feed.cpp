// SPDX-License-Identifier: BSD-3-Clause
#include "common/foxglove/feed.hpp"

#include <utility>

#include "common/foxglove/voxel_grid.hpp"
#include "common/node/messages.hpp"

namespace nodmap::foxglove {
namespace {

/// A tick of the viewer and a burst of parts lie well within this.
constexpr int kQueue = 512;
constexpr std::size_t kLogLines = 500;
/// Poses of keyframes are all kept: none is nearer than this to the last by itself.
constexpr double kEachKeyframe = 0.0;

bool same_lengths(const nodmap::egomap_t& map) {
  const auto bins = static_cast<std::size_t>(map.num_bins);
  return map.distance_m.size() == bins && map.point_x_m.size() == bins &&
         map.point_y_m.size() == bins && map.point_z_m.size() == bins && map.age_s.size() == bins;
}

}  // namespace

Feed::Topics::Topics(Board& board, const FeedOptions& options)
    : scan(board.add({"SCAN", "foxglove.LaserScan"})),
      pitch_state(board.add({"PITCH_STATE", "nodmap.pitch_state_t"})),
      pitch_command(board.add({"PITCH_COMMAND", "nodmap.pitch_command_t"})),
      odometry(board.add({"ODOMETRY", "nodmap.odometry_t"})),
      drive(board.add({"DRIVE", "nodmap.drive_t"})),
      navigation(board.add({"NAVIGATION", "nodmap.navigation_t"})),
      pose_2d(board.add({"POSE_2D", "nodmap.pose_t"})),
      pose_6d(board.add({"POSE_6D", "nodmap.pose_t"})),
      goal(board.add({"GOAL", "nodmap.goal_t"})),
      stop(board.add({"STOP", "nodmap.stop_t"})),
      base_sensors(board.add({"BASE_SENSORS", "nodmap.base_sensors_t"})),
      truth(board.add({"TRUTH", "nodmap.truth_t"})),
      status(board.add({"STATUS", "nodmap.processes"})),
      pm_info(board.add({"PM_INFO", "nodmap.commands"})),
      obstacle_map(board.add({"OBSTACLE_MAP", "foxglove.PointCloud"})),
      structure_map(board.add({"STRUCTURE_MAP", "foxglove.PointCloud"})),
      map_2d(board.add({"MAP_2D", "foxglove.Grid"})),
      cloud(board.add({"CLOUD", "foxglove.PointCloud", Keep::kAll, options.max_cloud_points})),
      octomap(board.add({"OCTOMAP", "foxglove.VoxelGrid"})),
      tf_base(board.add({"tf/base", "foxglove.FrameTransform"})),
      tf_map(board.add({"tf/map", "foxglove.FrameTransform"})),
      tf_map_6d(board.add({"tf/map_6d", "foxglove.FrameTransform"})),
      tf_world(board.add({"tf/world", "foxglove.FrameTransform"})),
      trail_odometry(board.add({"trail/odometry", "foxglove.PosesInFrame"})),
      trail_2d(board.add({"trail/2d", "foxglove.PosesInFrame"})),
      trail_6d(board.add({"trail/6d", "foxglove.PosesInFrame"})),
      keyframes(board.add({"keyframes", "foxglove.PosesInFrame"})),
      body(board.add({"scene/robot", "foxglove.SceneUpdate"})),
      corridor(board.add({"scene/corridor", "foxglove.SceneUpdate"})),
      area_of_interest(board.add({"scene/area_of_interest", "foxglove.SceneUpdate"})),
      goal_mark(board.add({"scene/goal", "foxglove.SceneUpdate"})),
      people(board.add({"scene/people", "foxglove.SceneUpdate"})),
      log(board.add({"log", "foxglove.Log", Keep::kAll, kLogLines})) {}

Feed::Feed(bus::Bus& bus, Board& board, node::MessageCounts& counts, const FeedOptions& options)
    : board_(board),
      counts_(counts),
      topics_(board, options),
      odometry_trail_(frames::kOdom, options.trail_spacing_m),
      trail_2d_(frames::kMap, options.trail_spacing_m),
      trail_6d_(frames::kMap6d, options.trail_spacing_m),
      keyframes_(frames::kMap6d, kEachKeyframe),
      cloud_thinner_(options.cloud_spacing_m, options.max_cloud_points) {
  hear_sensors(bus);
  hear_decisions(bus);
  hear_maps(bus);
}

void Feed::reset() {
  for (Trail* trail : {&odometry_trail_, &trail_2d_, &trail_6d_, &keyframes_}) {
    trail->clear();
  }
  grid_ = {};
  cloud_ = {};
  cloud_thinner_.clear();
  processes_.clear();
  body_posted_ = false;
  octomap_ = {};
  commands_.clear();
}

template <class Message, class Handler>
void Feed::hear(bus::Bus& bus, const char* channel, Handler handler) {
  bus.subscribe<Message>(channel, std::move(handler), kQueue);
}

template <class Make>
void Feed::post(std::size_t topic, std::int64_t utime_us, Make make) {
  board_.post(topic, utime_us, [make = std::move(make)] { return to_text(make()); });
}

template <class Message>
void Feed::post_fields(std::size_t topic, const Message& message) {
  counts_.use();
  post(topic, message.utime, [message] { return fields_of(message); });
}

void Feed::hear_sensors(bus::Bus& bus) {
  hear<nodmap::scan_t>(bus, "SCAN", [this](const auto& message) { on_scan(message); });
  hear<nodmap::pitch_state_t>(bus, "PITCH_STATE", [this](const auto& message) {
    post_fields(topics_.pitch_state, message);
  });
  hear<nodmap::odometry_t>(bus, "ODOMETRY", [this](const auto& message) { on_odometry(message); });
  hear<nodmap::base_sensors_t>(bus, "BASE_SENSORS", [this](const auto& message) {
    post_fields(topics_.base_sensors, message);
  });
  hear<procman_lcm::deputy_info_t>(bus, "PM_INFO",
                                   [this](const auto& message) { on_deputy_info(message); });
  hear<nodmap::status_t>(bus, "STATUS", [this](const auto& message) { on_status(message); });
  hear<nodmap::truth_t>(bus, "TRUTH", [this](const auto& message) { on_truth(message); });
}

void Feed::hear_decisions(bus::Bus& bus) {
  hear<nodmap::drive_t>(bus, "DRIVE",
                        [this](const auto& message) { post_fields(topics_.drive, message); });
  hear<nodmap::navigation_t>(bus, "NAVIGATION", [this](const auto& message) {
    post_fields(topics_.navigation, message);
    post(topics_.corridor, message.utime,
         [message, body = body_] { return corridor_scene(message, body); });
  });
  hear<nodmap::pitch_command_t>(bus, "PITCH_COMMAND", [this](const auto& message) {
    post_fields(topics_.pitch_command, message);
    post(topics_.area_of_interest, message.utime, [message, p = p_base_mount_, body = body_] {
      return area_of_interest_scene(message, p, body);
    });
  });
  hear<nodmap::stop_t>(bus, "STOP",
                       [this](const auto& message) { post_fields(topics_.stop, message); });
  hear<nodmap::goal_t>(bus, "GOAL", [this](const auto& message) {
    post_fields(topics_.goal, message);
    post(topics_.goal_mark, message.utime, [message] { return goal_scene(message); });
  });
}

void Feed::hear_maps(bus::Bus& bus) {
  hear<nodmap::egomap_t>(bus, "OBSTACLE_MAP",
                         [this](const auto& message) { on_egomap(topics_.obstacle_map, message); });
  hear<nodmap::egomap_t>(bus, "STRUCTURE_MAP", [this](const auto& message) {
    on_egomap(topics_.structure_map, message);
  });
  hear<nodmap::pose_t>(bus, "POSE_2D", [this](const auto& message) { on_pose_2d(message); });
  hear<nodmap::pose_t>(bus, "POSE_6D", [this](const auto& message) { on_pose_6d(message); });
  hear<nodmap::grid_chunk_t>(bus, "MAP_2D", [this](const auto& message) { on_grid(message); });
  hear<nodmap::cloud_chunk_t>(bus, "CLOUD", [this](const auto& message) { on_cloud(message); });
  hear<nodmap::octomap_chunk_t>(bus, "OCTOMAP",
                                [this](const auto& message) { on_octomap(message); });
}

void Feed::on_scan(const nodmap::scan_t& message) {
  scan::Scan scan;
  if (!node::read_scan(message, scan)) {
    counts_.reject("scan_not_plausible");
    return;
  }
  counts_.use();
  p_base_mount_ = scan.T_base_mount.translation();
  post(topics_.scan, message.utime, [scan = std::move(scan)] { return laser_scan(scan); });
}

void Feed::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = node::read_odometry(message);
  if (!T_odom_base) {
    counts_.reject("pose_not_valid");
    return;
  }
  post_fields(topics_.odometry, message);
  post(topics_.tf_base, message.utime, [utime = message.utime, pose = *T_odom_base] {
    return frame_transform(utime, frames::kOdom, frames::kBase, pose);
  });
  post_trail(topics_.trail_odometry, odometry_trail_, message.utime, *T_odom_base);
  if (!body_posted_) {
    body_posted_ = true;
    post(topics_.body, message.utime,
         [utime = message.utime, body = body_] { return body_scene(utime, body); });
  }
}

void Feed::post_trail(std::size_t topic, Trail& trail, std::int64_t utime_us,
                      const geometry::SE3& T_frame_base) {
  trail.add(utime_us, T_frame_base);
  if (trail.take_turn(utime_us)) {
    // By reference: the trail lives as long as the board's readers, and only grows.
    post(topic, utime_us, [&trail] { return trail.poses_in_frame(); });
  }
}

void Feed::on_pose_2d(const nodmap::pose_t& message) {
  const auto T_map_base = node::read_pose(message.position_m, message.orientation);
  const auto T_map_odom = node::read_pose(message.odom_position_m, message.odom_orientation);
  if (!T_map_base || !T_map_odom) {
    counts_.reject("pose_not_valid");
    return;
  }
  post_fields(topics_.pose_2d, message);
  post(topics_.tf_map, message.utime, [utime = message.utime, pose = *T_map_odom] {
    return frame_transform(utime, frames::kMap, frames::kOdom, pose);
  });
  post_trail(topics_.trail_2d, trail_2d_, message.utime, *T_map_base);
}

void Feed::on_pose_6d(const nodmap::pose_t& message) {
  const auto T_map_base = node::read_pose(message.position_m, message.orientation);
  const auto T_map_odom = node::read_pose(message.odom_position_m, message.odom_orientation);
  if (!T_map_base || !T_map_odom) {
    counts_.reject("pose_not_valid");
    return;
  }
  post_fields(topics_.pose_6d, message);
  // The other way round: a frame has one parent, and odom's is map.
  post(topics_.tf_map_6d, message.utime, [utime = message.utime, pose = T_map_odom->inverse()] {
    return frame_transform(utime, frames::kOdom, frames::kMap6d, pose);
  });
  post_trail(topics_.trail_6d, trail_6d_, message.utime, *T_map_base);
}

void Feed::on_egomap(std::size_t topic, const nodmap::egomap_t& message) {
  const auto T_odom_base = node::read_pose(message.position_m, message.orientation);
  if (!T_odom_base || !same_lengths(message)) {
    counts_.reject("egomap_not_valid");
    return;
  }
  counts_.use();
  post(topic, message.utime,
       [message, pose = *T_odom_base] { return egomap_cloud(message, pose); });
}

void Feed::on_grid(const nodmap::grid_chunk_t& message) {
  Assembled<GridView> result = grid_.add(message);
  if (result.refused) {
    counts_.reject("map_tile_not_valid");
    return;
  }
  counts_.use();
  counts_.lose(result.lost ? 1 : 0);
  if (result.whole) {
    post(topics_.map_2d, message.utime, [view = std::move(*result.whole)] { return grid(view); });
  }
}

void Feed::on_cloud(const nodmap::cloud_chunk_t& message) {
  Assembled<CloudView> result = cloud_.add(message);
  if (result.refused) {
    counts_.reject("cloud_part_not_valid");
    return;
  }
  counts_.use();
  counts_.lose(result.lost ? 1 : 0);
  if (!result.whole) {
    return;
  }
  keyframes_.add(message.utime, result.whole->T_frame_points);
  post(topics_.keyframes, message.utime, [this] { return keyframes_.poses_in_frame(); });
  cloud_thinner_.thin(*result.whole);
  const std::size_t points = result.whole->xyz_m.size() / 3;
  if (points == 0) {
    return;
  }
  board_.post(
      topics_.cloud, message.utime,
      [view = std::move(*result.whole)] { return to_text(point_cloud(view)); }, points);
}

void Feed::on_octomap(const nodmap::octomap_chunk_t& message) {
  Assembled<OctomapView> result = octomap_.add(message);
  if (result.refused) {
    counts_.reject("octomap_part_not_valid");
    return;
  }
  counts_.use();
  counts_.lose(result.lost ? 1 : 0);
  if (result.whole) {
    post(topics_.octomap, message.utime, [view = std::move(*result.whole)] {
      return voxel_grid(view.utime_us, to_voxel_grid(view.space));
    });
  }
}

void Feed::on_deputy_info(const procman_lcm::deputy_info_t& message) {
  if (!commands_.update(message)) {
    counts_.reject("too_many_commands");
    return;
  }
  counts_.use();
  post(topics_.pm_info, message.utime, [this] { return commands_.commands(); });
}

void Feed::know_commands(std::vector<CommandTable::Known> commands) {
  commands_.know(std::move(commands));
  post(topics_.pm_info, 0, [this] { return commands_.commands(); });
}

void Feed::on_status(const nodmap::status_t& message) {
  const ProcessTable::Change change = processes_.update(message);
  if (!change.taken) {
    counts_.reject("too_many_processes");
    return;
  }
  counts_.use();
  post(topics_.status, message.utime, [this] { return processes_.processes(); });
  if (change.health_changed) {
    post(topics_.log, message.utime, [message] { return health_log(message); });
  }
}

void Feed::on_truth(const nodmap::truth_t& message) {
  const auto T_world_base = node::read_pose(message.position_m, message.orientation);
  if (!T_world_base) {
    counts_.reject("pose_not_valid");
    return;
  }
  post_fields(topics_.truth, message);
  post(topics_.tf_world, message.utime, [utime = message.utime, pose = T_world_base->inverse()] {
    return frame_transform(utime, frames::kBase, frames::kWorld, pose);
  });
  post(topics_.people, message.utime, [message] { return people_scene(message); });
}

}  // namespace nodmap::foxglove
