// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registered_cloud.hpp"

#include <algorithm>
#include <cmath>

#include "modules/slam6d/point_index.hpp"

namespace nodmap::slam6d {
namespace {

// A measured point is not farther than this from the surface point that stands for it.
constexpr double kSurfaceReachM = 0.3;

}  // namespace

std::vector<RegisteredPoint> registered_cloud(std::span<const Keyframe> keyframes) {
  std::vector<RegisteredPoint> points;
  for (const Keyframe& keyframe : keyframes) {
    PointIndex surface;
    surface.add(keyframe.surface.points);
    for (const Eigen::Vector3f& p : keyframe.cloud.points) {
      const Eigen::Vector3d p_base = p.cast<double>();
      const auto nearest = surface.nearest(p_base, kSurfaceReachM);
      const Eigen::Vector3d normal_base =
          nearest ? keyframe.surface.normals[nearest->index] : Eigen::Vector3d::Zero();
      points.push_back({(keyframe.T_map_base * p_base).cast<float>(),
                        (keyframe.T_map_base.linear() * normal_base).cast<float>()});
    }
  }
  return points;
}

HeightRange height_range(std::span<const RegisteredPoint> points) {
  std::vector<float> heights;
  heights.reserve(points.size());
  for (const RegisteredPoint& point : points) {
    heights.push_back(point.p_map.z());
  }
  HeightRange range;
  range.low_m = quantile(heights, 0.02);
  range.high_m = std::max(quantile(std::move(heights), 0.90), range.low_m + 0.1F);
  return range;
}

float quantile(std::vector<float> values, double share) {
  if (values.empty()) {
    return 0.0F;
  }
  const auto place = std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

}  // namespace nodmap::slam6d
