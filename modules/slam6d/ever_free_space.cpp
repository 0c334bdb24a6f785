// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/ever_free_space.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "modules/slam6d/cloud_voxels.hpp"

namespace nodmap::slam6d {
namespace {

/// Of the keyframes, for one voxel.
struct Votes {
  std::int32_t free = 0;      ///< beams went through, and none ended in or beside it
  std::int32_t occupied = 0;  ///< a beam ended in or beside it
};

/// The voxels in which a point of any keyframe lies, in order, each once.
std::vector<VoxelCode> end_voxels(const OctreeGrid& grid, std::span<const Keyframe> keyframes) {
  std::vector<VoxelCode> ends;
  for (const Keyframe& keyframe : keyframes) {
    for (const Eigen::Vector3f& p : keyframe.cloud->points) {
      const Eigen::Vector3f p_map = (keyframe.T_map_base * p.cast<double>()).cast<float>();
      if (const auto key = grid.key_of(p_map)) {
        ends.push_back(code_of(*key));
      }
    }
  }
  std::ranges::sort(ends);
  ends.erase(std::ranges::unique(ends).begin(), ends.end());
  return ends;
}

/// One axis of a code, as a number.
std::uint16_t compact_bits(VoxelCode code) {
  code &= 0x249249249249ULL;
  code = (code | code >> 2U) & 0x0C30C30C30C3ULL;
  code = (code | code >> 4U) & 0x00F00F00F00FULL;
  code = (code | code >> 8U) & 0x0000FF0000FFULL;
  return static_cast<std::uint16_t>(code | code >> 16U);
}

/// A voxel and the 26 beside it.
std::array<VoxelCode, 27> neighbourhood(VoxelCode voxel) {
  const VoxelKey key{compact_bits(voxel), compact_bits(voxel >> 1U), compact_bits(voxel >> 2U)};
  std::array<VoxelCode, 27> codes{};
  for (int i = 0; i < 27; ++i) {
    const auto beside = [&key](std::size_t axis, int offset) {
      return static_cast<std::uint16_t>(key[axis] + offset - 1);
    };
    codes[static_cast<std::size_t>(i)] =
        code_of({beside(0, i % 3), beside(1, i / 3 % 3), beside(2, i / 9)});
  }
  return codes;
}

bool is_occupied_about(const CloudVoxels& seen, VoxelCode voxel) {
  return std::ranges::any_of(neighbourhood(voxel),
                             [&seen](VoxelCode code) { return seen.is_occupied(code); });
}

/// What one keyframe saw. The voxels of a cube follow one another in the order of codes.
void vote(const CloudVoxels& seen, std::span<const VoxelCode> ends, std::vector<Votes>& votes) {
  for (const auto& cube : seen.cubes()) {
    const VoxelCode first = cube->code << 3U * CloudVoxels::kLevels;
    const VoxelCode after = (cube->code + 1) << 3U * CloudVoxels::kLevels;
    for (auto end = std::ranges::lower_bound(ends, first); end != ends.end() && *end < after;
         ++end) {
      Votes& here = votes[static_cast<std::size_t>(end - ends.begin())];
      if (is_occupied_about(seen, *end)) {
        ++here.occupied;
      } else if (seen.is_free(*end)) {
        ++here.free;
      }
    }
  }
}

bool is_enclosed(const CloudVoxels& seen, VoxelCode voxel) {
  return std::ranges::all_of(neighbourhood(voxel),
                             [&seen](VoxelCode code) { return seen.is_free(code); });
}

}  // namespace

EverFreeSpace::EverFreeSpace(const EverFreeParams& params, std::span<const Keyframe> keyframes)
    : grid_(params.voxel_size_m) {
  CloudTracer tracer({.resolution_m = params.voxel_size_m, .max_range_m = params.max_range_m});
  const std::vector<VoxelCode> ends = end_voxels(grid_, keyframes);
  std::vector<Votes> votes(ends.size());
  CloudVoxels all;
  CloudVoxels of_one;
  for (const Keyframe& keyframe : keyframes) {
    of_one.clear();
    tracer.trace(*keyframe.cloud, keyframe.T_map_base, of_one);
    vote(of_one, ends, votes);
    tracer.trace(*keyframe.cloud, keyframe.T_map_base, all);
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (votes[i].free >= votes[i].occupied && is_enclosed(all, ends[i])) {
      moved_.push_back(ends[i]);
    }
  }
}

bool EverFreeSpace::contains(const Eigen::Vector3f& p_map) const {
  const auto key = grid_.key_of(p_map);
  return key && std::ranges::binary_search(moved_, code_of(*key));
}

}  // namespace nodmap::slam6d
