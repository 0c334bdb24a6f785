// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/test/robot_maps.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "modules/viewer/foxglove/test/robot_messages.hpp"

namespace nodmap::foxglove::test {
namespace {

using VoxelKeys = std::vector<std::array<int, 3>>;

// Appends the node `level` levels above these voxels, and everything below it.
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

std::vector<nodmap::cloud_chunk_t> keyframe_at(double time_s, std::int64_t id, int num_points) {
  constexpr int kPointsPerChunk = 5000;
  std::vector<nodmap::cloud_chunk_t> chunks;
  for (int first = 0; first < num_points; first += kPointsPerChunk) {
    nodmap::cloud_chunk_t chunk{};
    chunk.utime = utime(time_s);
    chunk.keyframe_id = id;
    chunk.chunk_index = first / kPointsPerChunk;
    chunk.num_chunks = (num_points + kPointsPerChunk - 1) / kPointsPerChunk;
    chunk.position_m[0] = kSpeedMps * time_s;
    chunk.orientation[0] = 1.0;
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

}  // namespace nodmap::foxglove::test
