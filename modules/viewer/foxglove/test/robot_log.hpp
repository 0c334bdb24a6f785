// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nodmap/base_sensors_t.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/exploration_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/local_map_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/octomap_chunk_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/path_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/pose_graph_6d_t.hpp"
#include "nodmap/pose_graph_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"
#include "nodmap/tracks_t.hpp"
#include "nodmap/truth_t.hpp"
#include "procman_lcm/deputy_info_t.hpp"

namespace nodmap::foxglove::test {

/// A robot that nods and drives along a corridor with walls 2 m to each side. Each function returns
/// a channel's message at a time (s) since kBeginUs, with values computed from it.
inline constexpr std::int64_t kBeginUs = 1'700'000'000'000'000;

[[nodiscard]] nodmap::scan_t scan_at(double time_s);
[[nodiscard]] nodmap::odometry_t odometry_at(double time_s);
[[nodiscard]] nodmap::pitch_state_t pitch_state_at(double time_s);
[[nodiscard]] nodmap::pitch_command_t pitch_command_at(double time_s);
[[nodiscard]] nodmap::drive_t drive_at(double time_s);
[[nodiscard]] nodmap::navigation_t navigation_at(double time_s);
[[nodiscard]] nodmap::egomap_t egomap_at(double time_s);
[[nodiscard]] nodmap::pose_t pose_at(double time_s);
[[nodiscard]] nodmap::truth_t truth_at(double time_s);
[[nodiscard]] nodmap::goal_t goal();
[[nodiscard]] nodmap::path_t path();
/// A square of 4 m with floor, behind it an obstacle and a hole, in cells of 5 cm.
[[nodiscard]] nodmap::local_map_t local_map();
/// Somebody who walks, and somebody out of sight.
[[nodiscard]] nodmap::tracks_t tracks();
[[nodiscard]] nodmap::exploration_t exploration();
[[nodiscard]] nodmap::pose_graph_t pose_graph();
/// With two keyframes; the first is that of keyframe_at(0.0, 0), moved two metres ahead.
[[nodiscard]] nodmap::pose_graph_6d_t pose_graph_6d();
[[nodiscard]] nodmap::stop_t stop();
[[nodiscard]] nodmap::base_sensors_t base_sensors_at(double time_s);
[[nodiscard]] nodmap::status_t status_at(double time_s);
[[nodiscard]] procman_lcm::deputy_info_t deputy_info_at(double time_s);
/// A keyframe of `num_points` points on the walls, in parts.
[[nodiscard]] std::vector<nodmap::cloud_chunk_t> keyframe_at(double time_s, std::int64_t id,
                                                             int num_points);
/// A grid of 120 x 80 cells in two tiles.
[[nodiscard]] std::vector<nodmap::grid_chunk_t> map_at(double time_s, std::int64_t revision);
/// The walls from -1 to 5 m and up to 2 m in voxels of 10 cm, in parts of 200 bytes.
[[nodiscard]] std::vector<nodmap::octomap_chunk_t> octomap_at(double time_s, std::int64_t revision);

/// The bytes of an OctoMap file in which these voxels are occupied (indices from the origin, each
/// once), without pruned or free nodes.
[[nodiscard]] std::string octomap_bytes(double voxel_m,
                                        const std::vector<std::array<int, 3>>& voxels);

struct RobotLog {
  double duration_s = 10.0;
  int points_per_keyframe = 12'000;
  double keyframe_every_s = 1.0;
};

/// Writes all channels at their usual rates.
void write_robot_log(const std::filesystem::path& file, const RobotLog& settings);

}  // namespace nodmap::foxglove::test
