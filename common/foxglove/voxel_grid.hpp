// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "common/formats/octomap_file.hpp"
#include "common/foxglove/foxglove.hpp"

namespace nodmap::foxglove {

/// Occupied space as a dense grid around it: slices along z, in them rows along y, x fastest.
struct VoxelGrid {
  /// A viewer holds and draws so many at once; coarser cells where the space needs more.
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 20U;

  Eigen::Vector3d p_corner = Eigen::Vector3d::Zero();  ///< outer corner of the first cell, metres
  double cell_m = 0.0;  ///< edge: that of a voxel, doubled until the grid has at most kMaxCells
  std::int64_t columns = 0;
  std::int64_t rows = 0;
  std::int64_t slices = 0;
  std::vector<std::uint8_t> cells;  ///< 1: something in it is occupied; 0: free or unknown
};

/// Nothing occupied gives a single free cell.
[[nodiscard]] VoxelGrid to_voxel_grid(const formats::OccupiedSpace& space);

/// foxglove.VoxelGrid in frame map_6d, one field `occupied` (UINT8).
[[nodiscard]] Json voxel_grid(std::int64_t utime_us, const VoxelGrid& grid);

}  // namespace nodmap::foxglove
