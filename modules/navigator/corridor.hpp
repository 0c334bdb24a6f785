// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/footprint.hpp"
#include "modules/navigator/obstacle_points.hpp"

namespace nodmap::navigator {

using robot::Footprint;

/// Free way of the virtual corridor, metres: how far the origin of base may go along the arc of
/// this curvature (1/m, positive left) until the body, `side_margin_m` wider on each side, meets a
/// point. +infinity where it meets none within half a turn.
///
/// A point that is already within the margin, but not met, does not lock the robot: there the body
/// itself counts, so that it may drive past or away.
[[nodiscard]] double free_way(const Points& points_base, double curvature, const Footprint& body,
                              double side_margin_m);

/// The same backwards.
[[nodiscard]] double free_way_behind(const Points& points_base, double curvature,
                                     const Footprint& body, double side_margin_m);

/// How far, in radians >= 0, the body with a margin on all sides may turn on the spot; `side` is +1
/// for left, -1 for right. +infinity where it may turn all the way.
[[nodiscard]] double free_turn(const Points& points_base, double side, const Footprint& body,
                               double margin_m);

}  // namespace nodmap::navigator
