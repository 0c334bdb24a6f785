// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/obstacle_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::navigator {
namespace {

// Tolerance: distance and point are 32-bit copies of the same numbers.
bool fits(double distance_m, const Eigen::Vector2d& p) {
  return std::isfinite(distance_m) && distance_m >= 0.0 && p.allFinite() &&
         std::abs(p.norm() - distance_m) <= 1e-3 * (1.0 + distance_m);
}

}  // namespace

std::optional<Points> read_points(std::span<const float> distance_m, std::span<const float> x_m,
                                  std::span<const float> y_m) {
  if (distance_m.empty() || x_m.size() != distance_m.size() || y_m.size() != distance_m.size()) {
    return std::nullopt;
  }
  Points points;
  points.reserve(distance_m.size());
  for (std::size_t i = 0; i < distance_m.size(); ++i) {
    if (distance_m[i] == std::numeric_limits<float>::infinity()) {
      continue;
    }
    const Eigen::Vector2d p(static_cast<double>(x_m[i]), static_cast<double>(y_m[i]));
    if (!fits(static_cast<double>(distance_m[i]), p)) {
      return std::nullopt;
    }
    points.push_back(p);
  }
  return points;
}

Points move_to_base(const Points& points_map, const geometry::SE2& T_odom_map,
                    const geometry::SE2& T_odom_base) {
  const geometry::SE2 T_base_map = T_odom_base.inverse() * T_odom_map;
  const Eigen::Matrix2d R_base_map = T_base_map.rotation();
  const Eigen::Vector2d t_base_map = T_base_map.translation();
  Points points_base(points_map.size());
  std::ranges::transform(points_map, points_base.begin(),
                         [&](const Eigen::Vector2d& p_map) -> Eigen::Vector2d {
                           return R_base_map * p_map + t_base_map;
                         });
  return points_base;
}

}  // namespace nodmap::navigator
