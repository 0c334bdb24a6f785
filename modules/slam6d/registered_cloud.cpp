// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registered_cloud.hpp"

#include <algorithm>

#include "modules/slam6d/model/voxel_grid.hpp"

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

bool is_moved(const Keyframe& keyframe, std::size_t i) {
  return !keyframe.is_moved.empty() && keyframe.is_moved[i];
}

Eigen::Vector3f in_map(const Keyframe& keyframe, std::size_t i) {
  return (keyframe.T_map_base * keyframe.cloud->points[i].cast<double>()).cast<float>();
}

}  // namespace

std::size_t num_registered(std::span<const Keyframe> keyframes) {
  std::size_t number = 0;
  for (const Keyframe& keyframe : keyframes) {
    number += keyframe.cloud->points.size() -
              static_cast<std::size_t>(std::ranges::count(keyframe.is_moved, true));
  }
  return number;
}

std::vector<Eigen::Vector3f> registered_points(const Keyframe& keyframe) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(keyframe.cloud->points.size());
  for (std::size_t i = 0; i < keyframe.cloud->points.size(); ++i) {
    if (!is_moved(keyframe, i)) {
      points.push_back(in_map(keyframe, i));
    }
  }
  return points;
}

std::vector<drawing::DrawnPoint> drawn_cloud(std::span<const Keyframe> keyframes,
                                             std::size_t max_points) {
  const std::size_t every = num_registered(keyframes) / (max_points + 1) + 1;
  std::vector<drawing::DrawnPoint> points;
  std::size_t number = 0;
  for (const Keyframe& keyframe : keyframes) {
    const VoxelGrid normals_base = normals_of(keyframe.points);
    const Eigen::Matrix3f R_map_base = keyframe.T_map_base.linear().cast<float>();
    for (std::size_t i = 0; i < keyframe.cloud->points.size(); ++i) {
      if (!is_moved(keyframe, i) && number++ % every == 0) {
        points.push_back(
            {in_map(keyframe, i), R_map_base * normal_at(keyframe.cloud->points[i], normals_base)});
      }
    }
  }
  return points;
}

}  // namespace nodmap::slam6d
