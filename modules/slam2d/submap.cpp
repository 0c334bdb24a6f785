// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/submap.hpp"

namespace nodmap::slam2d {

std::vector<OrientedPoint> oriented_points(const Keyframe& keyframe) {
  std::vector<OrientedPoint> points;
  points.reserve(keyframe.points_base.size());
  for (std::size_t i = 0; i < keyframe.points_base.size(); ++i) {
    points.push_back(
        {keyframe.points_base[i].cast<double>(), keyframe.normals_base[i].cast<double>()});
  }
  return points;
}

void Submap::add(const geometry::SE2& T_submap_base, std::span<const OrientedPoint> points_base) {
  for (const OrientedPoint& point : points_base) {
    points.insert(T_submap_base * point);
  }
  T_submap_keyframe.push_back(T_submap_base);
}

}  // namespace nodmap::slam2d
