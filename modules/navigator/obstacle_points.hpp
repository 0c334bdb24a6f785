// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"

namespace nodmap::navigator {

/// Obstacles as points on the ground plane, metres, in the frame the name of the variable says.
using Points = std::vector<Eigen::Vector2d>;

/// The points of an egocentric map from its bins (distance, x and y), as in nodmap.egomap_t. A
/// distance of +infinity is a direction without a point. Empty if distance and point of any bin
/// disagree: a map with one wrong part is not used.
[[nodiscard]] std::optional<Points> read_points(std::span<const float> distance_m,
                                                std::span<const float> x_m,
                                                std::span<const float> y_m);

/// Transforms the points of a map made at T_odom_map into base at T_odom_base. The map is as old as
/// a scan and its transmission: at 1.5 m/s this moves a point by 3 cm, and at 60 degrees/s a point
/// at 2 m by 4 cm.
[[nodiscard]] Points move_to_base(const Points& points_map, const geometry::SE2& T_odom_map,
                                  const geometry::SE2& T_odom_base);

}  // namespace nodmap::navigator
