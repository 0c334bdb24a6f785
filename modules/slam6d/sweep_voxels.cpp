// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/sweep_voxels.hpp"

namespace nodmap::slam6d {
namespace {

PointTimes point_times(const SweepCloud& cloud) {
  PointTimes times;
  if (!cloud.is_stationary()) {
    times.half_path = cloud.half_path().cast<float>();
    times.times.reserve(cloud.points.size());
    for (const SweepCloud::Line& line : cloud.lines) {
      times.times.resize(line.end, static_cast<float>(line.time));
    }
  }
  return times;
}

}  // namespace

VoxelMap voxelize(const SweepCloud& cloud, const VoxelMapParams& params) {
  return VoxelMap::from_points(cloud.points, cloud.p_base_mirror(), params, point_times(cloud));
}

}  // namespace nodmap::slam6d
