// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/se2.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/people/person.hpp"

namespace nodmap::navigator {

/// The distance from the body to a point, metres; negative inside.
[[nodiscard]] double distance_to_body(const Eigen::Vector2d& p_base, const robot::Footprint& body);

/// Whether a person will be within `margin_m` of the body in `time_s` seconds, when the body is at
/// `pose_base` (in base, now). The person walks at constant velocity, as a disc that grows by the
/// error of the prediction.
[[nodiscard]] bool is_touched(const robot::Footprint& body, const geometry::SE2& pose_base,
                              const Person& person, double time_s, double margin_m);

}  // namespace nodmap::navigator
