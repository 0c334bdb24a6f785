// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/robot/footprint.hpp"
#include "modules/navigator/behaviours/side.hpp"
#include "modules/navigator/obstacle_points.hpp"

namespace nodmap::navigator {

/// A point this deep within the body is an error of the map, metres.
inline constexpr double kErrorOfMapM = 0.03;

/// Whether a point is so deep within the body that it is an error of the map: odometry has drifted
/// since it was seen. It is ignored, because it would block the robot for ever.
[[nodiscard]] bool is_error_of_map(const Eigen::Vector2d& p_base, const robot::Footprint& body);

/// Free distance in the virtual corridor, metres: how far the origin of base can move along an arc
/// (curvature in 1/m, positive left) until the body, `side_margin_m` wider on each side, touches a
/// point. +infinity if it touches none within half a circle.
///
/// For a point that is within the margin already, the margin does not count, so that the robot can
/// still drive past it or away.
[[nodiscard]] double free_distance(const Points& points_base, double curvature,
                                   const robot::Footprint& body, double side_margin_m);

/// The same, driving backwards.
[[nodiscard]] double free_distance_backwards(const Points& points_base, double curvature,
                                             const robot::Footprint& body, double side_margin_m);

/// How far the body, with a margin on all sides, can rotate on the spot: radians, not negative.
/// +infinity if nothing ends the rotation.
[[nodiscard]] double free_rotation(const Points& points_base, Side side,
                                   const robot::Footprint& body, double margin_m);

}  // namespace nodmap::navigator
