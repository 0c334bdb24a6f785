// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/sensor_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace nodmap::foxglove {
namespace {

// Rounds to tenths of a millimetre: finer than any of the sensors, with a third of the text.
double rounded_m(float range_m) {
  return std::round(1e4 * static_cast<double>(range_m)) / 1e4;
}

geometry::SE3 laser_pose(const scan::Scan& scan) {
  geometry::SE3 T_mount_laser = geometry::SE3::Identity();
  T_mount_laser.linear() = geometry::pitch_rotation(scan.pitch_mid_rad());
  T_mount_laser.translation() = T_mount_laser.linear() * scan.mirror_offset_m;
  return scan.T_base_mount * T_mount_laser;
}

using formats::OccupiedSpace;
using Keys = std::array<std::int64_t, 3>;

// A box of voxel keys, from `lower` (included) to `upper` (excluded).
struct Box {
  Keys lower{};
  Keys upper{};

  [[nodiscard]] std::int64_t size(std::size_t axis) const { return upper[axis] - lower[axis]; }
  [[nodiscard]] std::int64_t cells() const { return size(0) * size(1) * size(2); }
};

Box box_of(const OccupiedSpace::Cube& cube) {
  const std::int64_t edge = std::int64_t{1} << cube.level;
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.lower[axis] = cube.key[axis];
    box.upper[axis] = box.lower[axis] + edge;
  }
  return box;
}

Box box_around(const OccupiedSpace& space) {
  if (space.cubes.empty()) {
    constexpr std::int64_t kOrigin = OccupiedSpace::kOriginKey;
    return {{kOrigin, kOrigin, kOrigin}, {kOrigin + 1, kOrigin + 1, kOrigin + 1}};
  }
  Box all = box_of(space.cubes.front());
  for (const OccupiedSpace::Cube& cube : space.cubes) {
    const Box box = box_of(cube);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      all.lower[axis] = std::min(all.lower[axis], box.lower[axis]);
      all.upper[axis] = std::max(all.upper[axis], box.upper[axis]);
    }
  }
  return all;
}

// The cells, 2^level voxels along each edge, that overlap a box.
Box coarser(const Box& box, unsigned level) {
  Box cells;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells.lower[axis] = box.lower[axis] >> level;
    cells.upper[axis] = ((box.upper[axis] - 1) >> level) + 1;
  }
  return cells;
}

void fill(VoxelGrid& grid, const Box& whole, const Box& part) {
  for (std::int64_t z = part.lower[2]; z < part.upper[2]; ++z) {
    for (std::int64_t y = part.lower[1]; y < part.upper[1]; ++y) {
      const std::int64_t row = (z - whole.lower[2]) * grid.rows + (y - whole.lower[1]);
      const auto first = grid.cells.begin() + row * grid.columns + part.lower[0] - whole.lower[0];
      std::fill(first, first + part.size(0), std::uint8_t{1});
    }
  }
}

Json grid_json(const char* frame_id, const char* field, const GridView& view) {
  geometry::SE3 T_frame_corner = geometry::SE3::Identity();
  T_frame_corner.translation() = Eigen::Vector3d(view.origin_x_m, view.origin_y_m, 0.0);
  return {{"timestamp", time_json(view.stamp)},
          {"frame_id", frame_id},
          {"pose", pose_json(T_frame_corner)},
          {"column_count", view.width},
          {"cell_size", {{"x", view.cell_size_m}, {"y", view.cell_size_m}}},
          {"row_stride", view.width},
          {"cell_stride", 1},
          {"fields", packed_fields_json({{field, 0, NumericType::kInt8}})},
          {"data", base64(std::as_bytes(std::span(view.cells)))}};
}

}  // namespace

Json laser_scan(const scan::Scan& scan) {
  Json ranges = Json::array();
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    ranges.push_back(scan.is_hit(beam) ? rounded_m(scan.ranges_m[beam]) : 0.0);
  }
  const std::size_t last = scan.ranges_m.empty() ? 0 : scan.ranges_m.size() - 1;
  return {{"timestamp", time_json(scan.stamp)},  {"frame_id", frames::kBase},
          {"pose", pose_json(laser_pose(scan))}, {"start_angle", scan.angle_first_rad},
          {"end_angle", scan.angle_rad(last)},   {"ranges", std::move(ranges)},
          {"intensities", Json::array()}};
}

Json egomap_cloud(const nodmap::egomap_t& map, const geometry::SE3& T_odom_base) {
  std::vector<float> packed;
  packed.reserve(4 * map.distance_m.size());
  for (std::size_t i = 0; i < map.distance_m.size(); ++i) {
    if (std::isfinite(map.distance_m[i]) && std::isfinite(map.point_x_m[i]) &&
        std::isfinite(map.point_y_m[i]) && std::isfinite(map.point_z_m[i])) {
      packed.insert(packed.end(),
                    {map.point_x_m[i], map.point_y_m[i], map.point_z_m[i], map.age_s[i]});
    }
  }
  return {{"timestamp", time_json(time::from_utime(map.utime))},
          {"frame_id", frames::kOdom},
          {"pose", pose_json(T_odom_base)},
          {"point_stride", 16},
          {"fields", packed_fields_json({{"x", 0, NumericType::kFloat32},
                                         {"y", 4, NumericType::kFloat32},
                                         {"z", 8, NumericType::kFloat32},
                                         {"age", 12, NumericType::kFloat32}})},
          {"data", packed_floats(packed)}};
}

Json point_cloud(const CloudView& cloud) {
  return {{"timestamp", time_json(cloud.stamp)},
          {"frame_id", cloud.frame_id},
          {"pose", pose_json(cloud.T_frame_points)},
          {"point_stride", 12},
          {"fields", packed_fields_json({{"x", 0, NumericType::kFloat32},
                                         {"y", 4, NumericType::kFloat32},
                                         {"z", 8, NumericType::kFloat32}})},
          {"data", packed_floats(cloud.xyz_m)}};
}

Json grid(const GridView& view) {
  return grid_json(frames::kMap, "occupancy", view);
}

bool is_valid(const nodmap::local_map_t& map) {
  constexpr std::int32_t kMaxSide = 512;  // 12.8 m in cells of the navigator's own size
  const bool has_size =
      map.width > 0 && map.height > 0 && map.width <= kMaxSide && map.height <= kMaxSide;
  return has_size && map.num_cells == map.width * map.height && map.cell_size_m > 0.0 &&
         std::isfinite(map.cell_size_m + map.origin_m[0] + map.origin_m[1]);
}

Json local_map_grid(const nodmap::local_map_t& map) {
  return grid_json(frames::kOdom, "kind",
                   {time::from_utime(map.utime), map.cell_size_m, map.origin_m[0], map.origin_m[1],
                    map.width, map.height, map.cells});
}

VoxelGrid to_voxel_grid(const OccupiedSpace& space) {
  const Box voxels = box_around(space);
  unsigned level = 0;
  while (coarser(voxels, level).cells() > VoxelGrid::kMaxCells) {
    ++level;
  }
  const Box whole = coarser(voxels, level);
  VoxelGrid grid;
  grid.cell_m = space.voxel_m * static_cast<double>(std::int64_t{1} << level);
  grid.columns = whole.size(0);
  grid.rows = whole.size(1);
  grid.slices = whole.size(2);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t key = whole.lower[static_cast<std::size_t>(axis)] << level;
    grid.p_corner[axis] = space.voxel_m * static_cast<double>(key - OccupiedSpace::kOriginKey);
  }
  grid.cells.assign(static_cast<std::size_t>(whole.cells()), 0);
  for (const OccupiedSpace::Cube& cube : space.cubes) {
    fill(grid, whole, coarser(box_of(cube), level));
  }
  return grid;
}

Json voxel_grid(time::Timestamp stamp, const VoxelGrid& grid) {
  geometry::SE3 T_map_corner = geometry::SE3::Identity();
  T_map_corner.translation() = grid.p_corner;
  return {{"timestamp", time_json(stamp)},
          {"frame_id", frames::kMap6d},
          {"pose", pose_json(T_map_corner)},
          {"row_count", grid.rows},
          {"column_count", grid.columns},
          {"cell_size", vector_json(Eigen::Vector3d::Constant(grid.cell_m))},
          {"slice_stride", grid.rows * grid.columns},
          {"row_stride", grid.columns},
          {"cell_stride", 1},
          {"fields", packed_fields_json({{"occupied", 0, NumericType::kUint8}})},
          {"data", base64(std::as_bytes(std::span(grid.cells)))}};
}

}  // namespace nodmap::foxglove
