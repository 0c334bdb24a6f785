// SPDX-License-Identifier: BSD-3-Clause
// Measurements and maps as Foxglove's LaserScan, PointCloud, Grid and VoxelGrid.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/formats/octomap_file.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/local_map_t.hpp"

namespace nodmap::foxglove {

/// foxglove.LaserScan in frame base; its plane has the pitch of the scan's middle. A beam without a
/// valid reading has range 0, which is below every sensor's minimum, because JSON has no infinity.
[[nodiscard]] Json laser_scan(const scan::Scan& scan);

/// foxglove.PointCloud of the bins that contain a point, with fields x, y, z (m), age (s), in frame
/// odom at the reference pose of the map, which must be valid.
[[nodiscard]] Json egomap_cloud(const nodmap::egomap_t& map, const geometry::SE3& T_odom_base);

/// Points x, y, z, x, ... (m) in the frame of their pose.
struct CloudView {
  time::Timestamp stamp{};
  std::string frame_id;
  geometry::SE3 T_frame_points = geometry::SE3::Identity();
  std::vector<float> xyz_m;
};

/// foxglove.PointCloud with fields x, y, z.
[[nodiscard]] Json point_cloud(const CloudView& cloud);

/// An occupancy grid: rows along y, x fastest; 0 free .. 100 occupied, -1 unknown.
struct GridView {
  time::Timestamp stamp{};
  double cell_size_m = 0.0;
  double origin_x_m = 0.0;  ///< outer corner of the first cell
  double origin_y_m = 0.0;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<std::int8_t> cells;  ///< width * height
};

/// foxglove.Grid in frame map, one field `occupancy` (INT8).
[[nodiscard]] Json grid(const GridView& view);

/// Whether the map has as many cells as it claims, not too many, and a finite origin.
[[nodiscard]] bool is_valid(const nodmap::local_map_t& map);

/// foxglove.Grid in frame odom, with one field `kind` (INT8): the cell's value in local_map_t. The
/// map must be valid.
[[nodiscard]] Json local_map_grid(const nodmap::local_map_t& map);

/// Occupied space as a dense grid: slices along z, rows along y, x fastest.
struct VoxelGrid {
  /// Limit of what a viewer can store and draw; larger spaces get coarser cells.
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 20U;

  Eigen::Vector3d p_corner = Eigen::Vector3d::Zero();  ///< outer corner of the first cell, metres
  /// Edge of a cell: that of a voxel, doubled until the grid has at most kMaxCells.
  double cell_m = 0.0;
  std::int64_t columns = 0;
  std::int64_t rows = 0;
  std::int64_t slices = 0;
  std::vector<std::uint8_t> cells;  ///< 1: contains an occupied voxel; 0: free or unknown
};

/// Converts to a grid; without occupied voxels, to a single free cell.
[[nodiscard]] VoxelGrid to_voxel_grid(const formats::OccupiedSpace& space);

/// foxglove.VoxelGrid in frame map_6d, one field `occupied` (UINT8).
[[nodiscard]] Json voxel_grid(time::Timestamp stamp, const VoxelGrid& grid);

}  // namespace nodmap::foxglove
