// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/point_map.hpp"
#include "modules/slam2d/surface_point.hpp"

namespace nodmap::slam2d {

/// A scan that went into the map, kept so that its pose can be corrected later and grids be drawn
/// from it.
struct Keyframe {
  std::int64_t utime_us = 0;
  geometry::SE2 T_odom_base;
  geometry::SE2 T_map_base;
  Eigen::Vector2d eye_base = Eigen::Vector2d::Zero();  ///< where the rays come from
  std::vector<Eigen::Vector2f> points_base;
  std::vector<Eigen::Vector2f> normals_base;  ///< of each point; zero where it stands alone
};

[[nodiscard]] std::vector<SurfacePoint> surface_points(const Keyframe& keyframe);

/// Some metres of the path and what was seen from there: small enough that drift within does not
/// matter. Its frame is that of its first keyframe; when the graph moves it, its points stay.
struct Submap {
  Submap(std::size_t first, const geometry::SE2& pose, double neighbour_radius_m)
      : first_keyframe(first), T_map_submap(pose), points(neighbour_radius_m) {}

  /// Points without a neighbour within `new_point_distance_m` are added, the others tell once more
  /// where the lines through their places run.
  void add(const geometry::SE2& T_submap_keyframe, std::span<const SurfacePoint> points_base,
           double new_point_distance_m);

  [[nodiscard]] std::size_t end_keyframe() const {
    return first_keyframe + T_submap_keyframe.size();
  }
  [[nodiscard]] bool has(std::size_t keyframe) const {
    return keyframe >= first_keyframe && keyframe < end_keyframe();
  }
  [[nodiscard]] const geometry::SE2& pose_of(std::size_t keyframe) const {
    return T_submap_keyframe[keyframe - first_keyframe];
  }

  std::size_t first_keyframe;  ///< the others follow without a gap
  geometry::SE2 T_map_submap;
  std::vector<geometry::SE2> T_submap_keyframe;
  PointMap points;
};

}  // namespace nodmap::slam2d
