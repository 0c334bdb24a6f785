// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/submap.hpp"

namespace nodmap::slam2d {

std::vector<SurfacePoint> surface_points(const Keyframe& keyframe) {
  std::vector<SurfacePoint> points;
  points.reserve(keyframe.points_base.size());
  for (std::size_t i = 0; i < keyframe.points_base.size(); ++i) {
    points.push_back(
        {keyframe.points_base[i].cast<double>(), keyframe.normals_base[i].cast<double>()});
  }
  return points;
}

void Submap::add(const geometry::SE2& T_submap_base, std::span<const SurfacePoint> points_base,
                 double new_point_distance_m) {
  for (const SurfacePoint& point : points_base) {
    const SurfacePoint in_submap = T_submap_base * point;
    // Matched points are neglected: one point is enough for one place, whichever way it looks. But
    // each tells once more where the line through its place runs.
    if (points.nearest({in_submap.p, Eigen::Vector2d::Zero()}, new_point_distance_m) == nullptr) {
      points.add(in_submap);
    } else {
      points.refine(in_submap);
    }
  }
  T_submap_keyframe.push_back(T_submap_base);
}

}  // namespace nodmap::slam2d
