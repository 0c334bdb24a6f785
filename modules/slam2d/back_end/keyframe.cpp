// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/keyframe.hpp"

#include <utility>

namespace nodmap::slam2d {

void set_points(Keyframe& keyframe, std::span<const OrientedPoint> points_base) {
  std::vector<Eigen::Vector2f> points;
  std::vector<Eigen::Vector2f> normals;
  points.reserve(points_base.size());
  normals.reserve(points_base.size());
  for (const OrientedPoint& point : points_base) {
    points.emplace_back(point.p.cast<float>());
    normals.emplace_back(point.normal.cast<float>());
  }
  keyframe.points_base = SharedPoints(std::move(points));
  keyframe.normals_base = SharedPoints(std::move(normals));
}

std::vector<OrientedPoint> oriented_points(const Keyframe& keyframe) {
  std::vector<OrientedPoint> points;
  points.reserve(keyframe.points_base.size());
  for (std::size_t i = 0; i < keyframe.points_base.size(); ++i) {
    points.push_back(
        {keyframe.points_base[i].cast<double>(), keyframe.normals_base[i].cast<double>()});
  }
  return points;
}

View view_of(const Keyframe& keyframe) {
  std::vector<Eigen::Vector2d> points_base;
  points_base.reserve(keyframe.points_base.size());
  for (const Eigen::Vector2f& p : keyframe.points_base) {
    points_base.emplace_back(p.cast<double>());
  }
  return {std::move(points_base), keyframe.sensor_origin_base};
}

std::vector<OrientedPoint> some_points(const Keyframe& keyframe) {
  constexpr std::size_t kMaxScanPoints = 120;  // enough to match one scan
  const std::vector<OrientedPoint> all = oriented_points(keyframe);
  const std::size_t stride = (all.size() + kMaxScanPoints - 1) / kMaxScanPoints;
  std::vector<OrientedPoint> some;
  for (std::size_t i = 0; i < all.size(); i += stride) {
    some.push_back(all[i]);
  }
  return some;
}

}  // namespace nodmap::slam2d
