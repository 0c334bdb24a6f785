// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/test/robot_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"

namespace nodmap::foxglove::test {
namespace {

constexpr double kSpeedMps = 0.5;
constexpr double kHalfWidthM = 2.0;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::int64_t utime(double time_s) {
  return kBeginUs + std::llround(1e6 * time_s);
}

double pitch_rad(double time_s) {
  return 0.4 * std::sin(2.0 * std::numbers::pi * time_s / 1.2);
}

template <class Message>
void stand_at(Message& message, double x_m) {
  message.position_m[0] = x_m;
  message.orientation[0] = 1.0;
}

/// Distance to the nearer wall along a beam; infinity if it is too far.
float wall_range(double angle_rad) {
  const double range_m = kHalfWidthM / std::abs(std::sin(angle_rad));
  return range_m < 20.0 ? static_cast<float>(range_m) : kInfinity;
}

/// Adds the events of one channel to the list, which is sorted afterwards.
struct Event {
  std::int64_t utime_us;
  std::string channel;
  std::vector<std::byte> bytes;
};

template <class Message>
void note(std::vector<Event>& events, const std::string& channel, const Message& message) {
  Event event{message.utime, channel, {}};
  bus::encode_into(event.bytes, message);
  events.push_back(std::move(event));
}

void note_fast_channels(std::vector<Event>& events, double duration_s) {
  for (int i = 0; i < static_cast<int>(200.0 * duration_s); ++i) {
    note(events, "PITCH_STATE", pitch_state_at(i / 200.0));
  }
  for (int i = 0; i < static_cast<int>(100.0 * duration_s); ++i) {
    note(events, "ODOMETRY", odometry_at(i / 100.0));
  }
  for (int i = 0; i < static_cast<int>(50.0 * duration_s); ++i) {
    note(events, "TRUTH", truth_at(i / 50.0));
  }
}

void note_scan_channels(std::vector<Event>& events, double duration_s) {
  for (int i = 0; i < static_cast<int>(75.0 * duration_s); ++i) {
    const double time_s = i / 75.0;
    note(events, "SCAN", scan_at(time_s));
    note(events, "OBSTACLE_MAP", egomap_at(time_s));
    note(events, "STRUCTURE_MAP", egomap_at(time_s));
    note(events, "NAVIGATION", navigation_at(time_s));
    note(events, "DRIVE", drive_at(time_s));
    note(events, "PITCH_COMMAND", pitch_command_at(time_s));
  }
}

void note_slow_channels(std::vector<Event>& events, const RobotLog& settings) {
  note(events, "GOAL", goal());
  note(events, "PATH", path());
  note(events, "TRACKS", tracks());
  note(events, "LOCAL_MAP", local_map());
  note(events, "EXPLORATION", exploration());
  note(events, "POSE_GRAPH", pose_graph());
  nodmap::pose_graph_6d_t graph = pose_graph_6d();
  graph.position_m = {{0.0, 0.0, 0.0}, {kSpeedMps, 0.0, 0.0}};  // where CLOUD has them
  note(events, "POSE_GRAPH_6D", graph);
  note(events, "STOP", stop());
  for (int i = 0; i < static_cast<int>(20.0 * settings.duration_s); ++i) {
    note(events, "BASE_SENSORS", base_sensors_at(i / 20.0));
  }
  for (int i = 0; i < static_cast<int>(5.0 * settings.duration_s); ++i) {
    note(events, "POSE_2D", pose_at(i / 5.0));
  }
  for (int i = 0; i < static_cast<int>(settings.duration_s); ++i) {
    note(events, "STATUS", status_at(i));
    note(events, "PM_INFO", deputy_info_at(i));
    for (const auto& chunk : octomap_at(i, i)) {
      note(events, "OCTOMAP", chunk);
    }
    for (const auto& tile : map_at(i, i)) {
      note(events, "MAP_2D", tile);
    }
  }
  for (int i = 0; i * settings.keyframe_every_s < settings.duration_s; ++i) {
    const double time_s = i * settings.keyframe_every_s;
    note(events, "POSE_6D", pose_at(time_s));
    for (const auto& chunk : keyframe_at(time_s, i, settings.points_per_keyframe)) {
      note(events, "CLOUD", chunk);
    }
  }
}

using VoxelKeys = std::vector<std::array<int, 3>>;

/// Appends the node `level` levels above these voxels, and everything below it.
void append_node(std::string& bytes, int level, const VoxelKeys& keys) {
  std::array<VoxelKeys, 8> children;
  for (const auto& key : keys) {
    const auto bit = [&](int axis) {
      return key[static_cast<std::size_t>(axis)] >> (level - 1) & 1;
    };
    children[static_cast<std::size_t>(bit(0) | bit(1) << 1 | bit(2) << 2)].push_back(key);
  }
  unsigned states = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const unsigned state = children[i].empty() ? 0U : level == 1 ? 2U : 3U;
    states |= state << (2 * i);
  }
  bytes.push_back(static_cast<char>(states & 0xFFU));
  bytes.push_back(static_cast<char>(states >> 8U));
  for (const VoxelKeys& child : children) {
    if (!child.empty() && level > 1) {
      append_node(bytes, level - 1, child);
    }
  }
}

}  // namespace

std::string octomap_bytes(double voxel_m, const std::vector<std::array<int, 3>>& voxels) {
  constexpr int kOriginKey = 32768;
  VoxelKeys keys;
  for (const auto& voxel : voxels) {
    keys.push_back({voxel[0] + kOriginKey, voxel[1] + kOriginKey, voxel[2] + kOriginKey});
  }
  std::ostringstream head;
  head << "# Octomap OcTree binary file\n# made up for a test\nid OcTree\nsize 0\nres " << voxel_m
       << "\ndata\n";
  std::string bytes = head.str();
  if (!keys.empty()) {
    append_node(bytes, 16, keys);
  }
  return bytes;
}

nodmap::scan_t scan_at(double time_s) {
  nodmap::scan_t message{};
  message.utime = utime(time_s);
  message.beam_duration_us = 6'660;
  message.scan_seq = std::llround(75.0 * time_s);
  message.angle_first_rad = -std::numbers::pi / 2.0;
  message.angle_step_rad = std::numbers::pi / 360.0;
  message.pitch_first_rad = pitch_rad(time_s);
  message.pitch_last_rad = message.pitch_first_rad;
  message.pitch_is_measured = 1;
  message.range_min_m = 0.1;
  message.range_max_m = 20.0;
  message.mount_position_m[0] = 0.15;
  message.mount_position_m[2] = 0.4;
  message.mount_orientation[0] = 1.0;
  message.num_ranges = 361;
  for (int beam = 0; beam < message.num_ranges; ++beam) {
    message.ranges_m.push_back(wall_range(message.angle_first_rad + beam * message.angle_step_rad));
  }
  return message;
}

nodmap::odometry_t odometry_at(double time_s) {
  nodmap::odometry_t message{};
  message.utime = utime(time_s);
  message.odometry_seq = std::llround(100.0 * time_s);
  stand_at(message, kSpeedMps * time_s);
  message.forward_mps = kSpeedMps;
  return message;
}

nodmap::pitch_state_t pitch_state_at(double time_s) {
  nodmap::pitch_state_t message{};
  message.utime = utime(time_s);
  message.state_seq = std::llround(200.0 * time_s);
  message.pitch_rad = pitch_rad(time_s);
  message.pitch_is_measured = 1;
  return message;
}

nodmap::pitch_command_t pitch_command_at(double time_s) {
  nodmap::pitch_command_t message{};
  message.utime = utime(time_s);
  message.pitch_min_rad = -0.4;
  message.pitch_max_rad = 0.1;
  message.sweep_s = 0.6;
  message.max_forward_mps = 0.8;
  return message;
}

nodmap::drive_t drive_at(double time_s) {
  nodmap::drive_t message{};
  message.utime = utime(time_s);
  message.forward_mps = kSpeedMps;
  message.valid_us = 200'000;
  return message;
}

nodmap::navigation_t navigation_at(double time_s) {
  nodmap::navigation_t message{};
  message.utime = utime(time_s);
  message.behaviour = nodmap::navigation_t::STEER;
  message.corridor_length_m = 1.5;
  message.corridor_width_m = 0.5;
  message.clear_distance_m = std::numeric_limits<double>::infinity();
  message.max_forward_mps = 0.8;
  return message;
}

nodmap::egomap_t egomap_at(double time_s) {
  nodmap::egomap_t message{};
  message.utime = utime(time_s);
  message.bin_first_rad = -std::numbers::pi;
  message.bin_step_rad = std::numbers::pi / 180.0;
  stand_at(message, kSpeedMps * time_s);
  message.num_bins = 360;
  for (int bin = 0; bin < message.num_bins; ++bin) {
    const double angle_rad = message.bin_first_rad + bin * message.bin_step_rad;
    const float range_m = wall_range(angle_rad);
    const bool seen = std::isfinite(range_m);
    message.distance_m.push_back(range_m);
    message.point_x_m.push_back(seen ? range_m * static_cast<float>(std::cos(angle_rad)) : kNan);
    message.point_y_m.push_back(seen ? range_m * static_cast<float>(std::sin(angle_rad)) : kNan);
    message.point_z_m.push_back(seen ? 0.25F : kNan);
    message.age_s.push_back(seen ? 0.5F : kNan);
  }
  return message;
}

nodmap::pose_t pose_at(double time_s) {
  nodmap::pose_t message{};
  message.utime = utime(time_s);
  stand_at(message, kSpeedMps * time_s);
  message.position_m[1] = 0.1 * time_s / 10.0;  // what odometry has missed
  message.odom_position_m[1] = message.position_m[1];
  message.odom_orientation[0] = 1.0;
  message.inlier_ratio = 0.9;
  message.state = nodmap::pose_t::TRACKING;
  return message;
}

nodmap::truth_t truth_at(double time_s) {
  nodmap::truth_t message{};
  message.utime = utime(time_s);
  stand_at(message, 3.0 + kSpeedMps * time_s);
  message.forward_mps = kSpeedMps;
  message.clearance_m = 1.2;
  message.num_actors = 1;
  message.actor_position_m = {{6.0, 0.5 * std::sin(time_s)}};
  message.actor_radius_m = {0.25};
  message.actor_height_m = {1.75};
  return message;
}

nodmap::goal_t goal() {
  nodmap::goal_t message{};
  message.utime = kBeginUs;
  message.is_active = 1;
  message.position_m[0] = 8.0;
  message.tolerance_m = 0.3;
  return message;
}

nodmap::path_t path() {
  nodmap::path_t message{};
  message.utime = kBeginUs;
  message.num_points = 3;
  message.x_m = {0.0, 1.0, 2.0};
  message.y_m = {0.0, 0.0, 0.5};
  message.num_arc_points = 2;
  message.arc_x_m = {0.0, 0.8};
  message.arc_y_m = {0.0, 0.1};
  message.state = nodmap::path_t::PLANNED;
  return message;
}

nodmap::local_map_t local_map() {
  constexpr std::int32_t kSide = 80;
  nodmap::local_map_t message{};
  message.utime = kBeginUs;
  message.cell_size_m = 0.05;
  message.origin_m[0] = message.origin_m[1] = -2.0;
  message.width = message.height = kSide;
  message.num_cells = kSide * kSide;
  for (std::int32_t i = 0; i < message.num_cells; ++i) {
    const std::int32_t column = i % kSide;
    const std::int8_t behind =
        i / kSide < kSide / 2 ? nodmap::local_map_t::OBSTACLE : nodmap::local_map_t::HOLE;
    message.cells.push_back(column < 60   ? nodmap::local_map_t::FLOOR
                            : column < 64 ? behind
                                          : nodmap::local_map_t::NOT_SEEN);
  }
  return message;
}

nodmap::tracks_t tracks() {
  nodmap::tracks_t message{};
  message.utime = kBeginUs;
  message.num_tracks = 2;
  message.track_id = {3, 1};
  message.position_m = {{2.0, 1.0}, {-1.0, 0.0}};
  message.velocity_mps = {{-1.0, 0.0}, {0.0, 0.5}};
  message.radius_m = {0.25, 0.2};
  message.position_sigma_m = {0.05, 0.4};
  message.velocity_sigma_mps = {0.2, 0.5};
  message.state = {nodmap::tracks_t::WALKS, nodmap::tracks_t::OUT_OF_SIGHT};
  return message;
}

nodmap::exploration_t exploration() {
  nodmap::exploration_t message{};
  message.utime = kBeginUs;
  message.state = nodmap::exploration_t::EXPLORING;
  message.reason = "Driving to the next viewpoint.";
  message.seen_m2 = 40.0;
  message.waiting_m2 = 13.5;
  message.num_viewpoints = 2;
  message.viewpoint_x_m = {2.0, 5.0};
  message.viewpoint_y_m = {0.5, -1.0};
  message.gain_m2 = {10.0, 3.5};
  message.num_points = 3;
  message.x_m = {0.0, 1.0, 2.0};
  message.y_m = {0.0, 0.0, 0.5};
  message.num_frontier_points = 1;
  message.frontier_x_m = {2.5F};
  message.frontier_y_m = {0.5F};
  return message;
}

nodmap::pose_graph_t pose_graph() {
  nodmap::pose_graph_t message{};
  message.utime = kBeginUs;
  message.num_submaps = 3;
  message.x_m = {0.0, 1.0, 2.0};
  message.y_m = {0.0, 0.1, 0.2};
  message.yaw_rad = {0.0, 0.0, 0.0};
  message.num_loops = 2;
  message.from_submap = {0, 1};
  message.to_submap = {2, 2};
  message.loop_state = {nodmap::pose_graph_t::ACCEPTED, nodmap::pose_graph_t::AMBIGUOUS};
  message.loop_score = {0.9F, 0.6F};
  return message;
}

nodmap::pose_graph_6d_t pose_graph_6d() {
  nodmap::pose_graph_6d_t message{};
  message.utime = kBeginUs;
  message.num_keyframes = 2;
  message.keyframe_utime = {keyframe_at(0.0, 0, 1)[0].utime, keyframe_at(1.0, 1, 1)[0].utime};
  message.position_m = {{2.0, 0.0, 0.0}, {3.0, 0.0, 0.0}};
  message.orientation = {{1.0F, 0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F, 0.0F}};
  message.num_loops = 2;
  message.from_keyframe = {0, -1};
  message.to_keyframe = {1, 1};
  message.loop_state = {nodmap::pose_graph_6d_t::ACCEPTED, nodmap::pose_graph_6d_t::OUTLIER};
  return message;
}

nodmap::stop_t stop() {
  nodmap::stop_t message{};
  message.utime = kBeginUs;
  message.requested_by = "nodmap-viewer";
  return message;
}

nodmap::base_sensors_t base_sensors_at(double time_s) {
  nodmap::base_sensors_t message{};
  message.utime = utime(time_s);
  message.sonar_m = kNan;
  message.roll_rad = 0.01F;
  return message;
}

nodmap::status_t status_at(double time_s) {
  nodmap::status_t message{};
  message.utime = utime(time_s);
  message.process_name = "nodmap-slam2d";
  message.health = nodmap::status_t::OK;
  message.handled_per_s = 175.0;
  message.latency_p50_us = 120.0;
  message.latency_p99_us = 900.0;
  message.total_handled = std::llround(175.0 * time_s);
  return message;
}

procman_lcm::deputy_info_t deputy_info_at(double time_s) {
  procman_lcm::deputy_info_t message{};
  message.utime = utime(time_s);
  message.deputy_id = "robot";
  message.cpu_load = 0.25F;
  message.ncmds = 1;
  message.cmds.resize(1);
  message.cmds[0].cmd.command_id = "slam2d";
  message.cmds[0].cmd.exec_str = "nodmap-slam2d";
  message.cmds[0].cmd.group = "30.slam";
  message.cmds[0].pid = 4711;
  return message;
}

std::vector<nodmap::octomap_chunk_t> octomap_at(double time_s, std::int64_t revision) {
  constexpr int kBytesPerChunk = 200;
  std::vector<std::array<int, 3>> walls;
  for (int x = -10; x < 50; ++x) {
    for (int z = 0; z < 20; ++z) {
      walls.push_back({x, 20, z});
      walls.push_back({x, -21, z});
    }
  }
  const std::string file = octomap_bytes(0.1, walls);
  const int size = static_cast<int>(file.size());
  std::vector<nodmap::octomap_chunk_t> chunks;
  for (int first = 0; first < size; first += kBytesPerChunk) {
    nodmap::octomap_chunk_t chunk{};
    chunk.utime = utime(time_s);
    chunk.map_revision = revision;
    chunk.chunk_index = first / kBytesPerChunk;
    chunk.num_chunks = (size + kBytesPerChunk - 1) / kBytesPerChunk;
    chunk.num_bytes = std::min(kBytesPerChunk, size - first);
    chunk.bytes.assign(file.begin() + first, file.begin() + first + chunk.num_bytes);
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

std::vector<nodmap::cloud_chunk_t> keyframe_at(double time_s, std::int64_t id, int num_points) {
  constexpr int kPointsPerChunk = 5000;
  std::vector<nodmap::cloud_chunk_t> chunks;
  for (int first = 0; first < num_points; first += kPointsPerChunk) {
    nodmap::cloud_chunk_t chunk{};
    chunk.utime = utime(time_s);
    chunk.keyframe_id = id;
    chunk.chunk_index = first / kPointsPerChunk;
    chunk.num_chunks = (num_points + kPointsPerChunk - 1) / kPointsPerChunk;
    stand_at(chunk, kSpeedMps * time_s);
    chunk.num_points = std::min(kPointsPerChunk, num_points - first);
    for (int i = first; i < first + chunk.num_points; ++i) {
      // Walls on both sides: along x by the golden ratio, up by a second irrational step.
      const double along = std::fmod(0.618034 * i, 1.0);
      const double up = std::fmod(0.754878 * i, 1.0);
      const double side = i % 2 == 0 ? kHalfWidthM : -kHalfWidthM;
      chunk.points_m.push_back({static_cast<float>(6.0 * along - 1.0), static_cast<float>(side),
                                static_cast<float>(2.2 * up)});
    }
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

std::vector<nodmap::grid_chunk_t> map_at(double time_s, std::int64_t revision) {
  std::vector<nodmap::grid_chunk_t> tiles;
  for (int index = 0; index < 2; ++index) {
    nodmap::grid_chunk_t tile{};
    tile.utime = utime(time_s);
    tile.map_revision = revision;
    tile.chunk_index = index;
    tile.num_chunks = 2;
    tile.cell_size_m = 0.1;
    tile.origin_x_m = -2.0;
    tile.origin_y_m = -4.0;
    tile.grid_width = 120;
    tile.grid_height = 80;
    tile.tile_x = 60 * index;
    tile.tile_width = 60;
    tile.tile_height = 80;
    tile.num_cells = 60 * 80;
    for (int cell = 0; cell < tile.num_cells; ++cell) {
      const double y_m = tile.origin_y_m + (cell / 60 + 0.5) * tile.cell_size_m;
      const double off_wall_m = std::abs(y_m) - kHalfWidthM;
      tile.cells.push_back(off_wall_m > 0.1
                               ? std::int8_t{-1}
                               : static_cast<std::int8_t>(off_wall_m > -0.1 ? 100 : 0));
    }
    tiles.push_back(std::move(tile));
  }
  return tiles;
}

void write_robot_log(const std::filesystem::path& file, const RobotLog& settings) {
  std::vector<Event> events;
  note_fast_channels(events, settings.duration_s);
  note_scan_channels(events, settings.duration_s);
  note_slow_channels(events, settings);
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.utime_us < b.utime_us; });
  bus::LogWriter writer(file);
  for (const Event& event : events) {
    if (!writer.write(event.utime_us, event.channel, event.bytes)) {
      throw std::runtime_error(file.string() + ": cannot write");
    }
  }
}

}  // namespace nodmap::foxglove::test
