// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/keyframe.hpp"

#include <algorithm>
#include <iterator>

namespace nodmap::slam6d {

void Keyframe::keep_voxels(const VoxelMap& voxels) {
  points = oriented_points(voxels.level(0));
  const VoxelMap::Selection selection = voxels.select(0);
  coarse_planes.assign(
      selection.points.begin() + static_cast<std::ptrdiff_t>(selection.first_of_level[1]),
      selection.points.end());
}

std::vector<OrientedPoint> Keyframe::planes() const {
  std::vector<OrientedPoint> planes;
  planes.reserve(points.size() + coarse_planes.size());
  std::ranges::copy_if(points, std::back_inserter(planes),
                       [](const OrientedPoint& point) { return !point.normal.isZero(0.0F); });
  planes.insert(planes.end(), coarse_planes.begin(), coarse_planes.end());
  return planes;
}

}  // namespace nodmap::slam6d
