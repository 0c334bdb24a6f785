// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/local_map_t.hpp"
#include "nodmap/octomap_chunk_t.hpp"
#include "nodmap/pose_graph_6d_t.hpp"
#include "nodmap/pose_graph_t.hpp"

/// What the robot of robot_messages.hpp has mapped of its corridor.
namespace nodmap::foxglove::test {

/// A square of 4 m with floor, behind it an obstacle and a hole, in cells of 5 cm.
[[nodiscard]] nodmap::local_map_t local_map();
[[nodiscard]] nodmap::pose_graph_t pose_graph();
/// With two keyframes; the first is that of keyframe_at(0.0, 0), moved two metres ahead.
[[nodiscard]] nodmap::pose_graph_6d_t pose_graph_6d();
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

}  // namespace nodmap::foxglove::test
