// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registered_cloud.hpp"

#include <cstddef>

#include "modules/slam6d/voxel_grid.hpp"

namespace nodmap::slam6d {
namespace {

// A point takes the normal of the nearest voxel mean; the voxels have this size.
constexpr double kVoxelSizeM = 0.2;

}  // namespace

std::vector<drawing::DrawnPoint> registered_cloud(std::span<const Keyframe> keyframes) {
  std::vector<drawing::DrawnPoint> points;
  for (const Keyframe& keyframe : keyframes) {
    VoxelGrid means(kVoxelSizeM);
    for (const OrientedPoint& point : keyframe.points) {
      const std::uint32_t place = means.add(point.p, 1.0F);
      if (place != VoxelGrid::kNone && !point.normal.isZero(0.0F)) {
        means.add_normal(place, point.normal, 1.0F);
      }
    }
    for (std::size_t i = 0; i < keyframe.cloud->points.size(); ++i) {
      if (!keyframe.is_moved.empty() && keyframe.is_moved[i]) {
        continue;
      }
      const Eigen::Vector3f& p = keyframe.cloud->points[i];
      const std::uint32_t nearest = means.nearest(p, static_cast<float>(kVoxelSizeM));
      const Eigen::Vector3f normal_base =
          nearest == VoxelGrid::kNone ? Eigen::Vector3f::Zero() : means.voxels()[nearest].normal;
      points.push_back({(keyframe.T_map_base * p.cast<double>()).cast<float>(),
                        keyframe.T_map_base.linear().cast<float>() * normal_base});
    }
  }
  return points;
}

}  // namespace nodmap::slam6d
