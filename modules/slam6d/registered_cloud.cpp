// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registered_cloud.hpp"

#include <cstddef>

#include "modules/slam6d/voxel_grid.hpp"

namespace nodmap::slam6d {
namespace {

// A point takes the normal of the nearest voxel mean; the voxels have this size.
constexpr double kVoxelSizeM = 0.2;

VoxelGrid normals_of(std::span<const OrientedPoint> points) {
  VoxelGrid normals(kVoxelSizeM);
  for (const OrientedPoint& point : points) {
    const std::uint32_t place = normals.add(point.p, 1.0F);
    if (place != VoxelGrid::kNone && !point.normal.isZero(0.0F)) {
      normals.add_normal(place, point.normal, 1.0F);
    }
  }
  return normals;
}

Eigen::Vector3f normal_at(const Eigen::Vector3f& p, const VoxelGrid& normals) {
  const std::uint32_t nearest = normals.nearest(p, static_cast<float>(kVoxelSizeM));
  return nearest == VoxelGrid::kNone ? Eigen::Vector3f::Zero() : normals.voxels()[nearest].normal;
}

void add_keyframe(const Keyframe& keyframe, std::vector<drawing::DrawnPoint>& points) {
  const VoxelGrid normals_base = normals_of(keyframe.points);
  const Eigen::Matrix3f R_map_base = keyframe.T_map_base.linear().cast<float>();
  for (std::size_t i = 0; i < keyframe.cloud->points.size(); ++i) {
    if (!keyframe.is_moved.empty() && keyframe.is_moved[i]) {
      continue;
    }
    const Eigen::Vector3f& p = keyframe.cloud->points[i];
    points.push_back({(keyframe.T_map_base * p.cast<double>()).cast<float>(),
                      R_map_base * normal_at(p, normals_base)});
  }
}

}  // namespace

std::vector<drawing::DrawnPoint> registered_cloud(std::span<const Keyframe> keyframes) {
  std::vector<drawing::DrawnPoint> points;
  for (const Keyframe& keyframe : keyframes) {
    add_keyframe(keyframe, points);
  }
  return points;
}

}  // namespace nodmap::slam6d
