// SPDX-License-Identifier: BSD-3-Clause
#include "common/foxglove/sensor_views.hpp"

#include <algorithm>
#include <cmath>

#include "common/foxglove/base64.hpp"

namespace nodmap::foxglove {
namespace {

/// Tenths of a millimetre: finer than any of the sensors, and a third of the text.
double rounded_m(float range_m) {
  return std::round(1e4 * static_cast<double>(range_m)) / 1e4;
}

geometry::SE3 laser_pose(const scan::Scan& scan) {
  geometry::SE3 T_mount_laser = geometry::SE3::Identity();
  T_mount_laser.linear() = geometry::pitch_rotation(scan.pitch_mid_rad());
  T_mount_laser.translation() = T_mount_laser.linear() * scan.mirror_offset_m;
  return scan.T_base_mount * T_mount_laser;
}

}  // namespace

Json laser_scan(const scan::Scan& scan) {
  Json ranges = Json::array();
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    ranges.push_back(scan.is_hit(beam) ? rounded_m(scan.ranges_m[beam]) : 0.0);
  }
  const std::size_t last = scan.ranges_m.empty() ? 0 : scan.ranges_m.size() - 1;
  return {{"timestamp", time_json(scan.utime_us)}, {"frame_id", frames::kBase},
          {"pose", pose_json(laser_pose(scan))},   {"start_angle", scan.angle_first_rad},
          {"end_angle", scan.angle_rad(last)},     {"ranges", std::move(ranges)},
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
  return {{"timestamp", time_json(map.utime)},
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
  return {{"timestamp", time_json(cloud.utime_us)},
          {"frame_id", cloud.frame_id},
          {"pose", pose_json(cloud.T_frame_points)},
          {"point_stride", 12},
          {"fields", packed_fields_json({{"x", 0, NumericType::kFloat32},
                                         {"y", 4, NumericType::kFloat32},
                                         {"z", 8, NumericType::kFloat32}})},
          {"data", packed_floats(cloud.xyz_m)}};
}

Json grid(const GridView& view) {
  geometry::SE3 T_map_corner = geometry::SE3::Identity();
  T_map_corner.translation() = Eigen::Vector3d(view.origin_x_m, view.origin_y_m, 0.0);
  return {{"timestamp", time_json(view.utime_us)},
          {"frame_id", frames::kMap},
          {"pose", pose_json(T_map_corner)},
          {"column_count", view.width},
          {"cell_size", {{"x", view.cell_size_m}, {"y", view.cell_size_m}}},
          {"row_stride", view.width},
          {"cell_stride", 1},
          {"fields", packed_fields_json({{"occupancy", 0, NumericType::kInt8}})},
          {"data", base64(std::as_bytes(std::span(view.cells)))}};
}

}  // namespace nodmap::foxglove
