// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/obstacle_points.hpp"

#include <algorithm>

namespace nodmap::navigator {
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
