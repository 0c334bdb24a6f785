// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se2.hpp"

namespace nodmap::navigator {

/// Obstacles as points on the ground plane, metres. The name of the variable says the frame.
using Points = std::vector<Eigen::Vector2d>;

/// Transforms the points of a map made at T_odom_map into base at T_odom_base. Needed because the
/// map is as old as a scan and its transmission, in which a point moves by 3 cm at 1.5 m/s, and a
/// point at 2 m by 4 cm at 60 degrees/s.
[[nodiscard]] Points move_to_base(const Points& points_map, const geometry::SE2& T_odom_map,
                                  const geometry::SE2& T_odom_base);

}  // namespace nodmap::navigator
