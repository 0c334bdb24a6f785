// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/se2.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/people/person.hpp"

namespace nodmap::navigator {

/// A motion of base: forward speed and yaw rate.
struct Twist {
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;

  [[nodiscard]] Twist scaled(double factor) const {
    return {factor * forward_mps, factor * yaw_rate_rad_s};
  }
};

/// The motion of the base `time_s` seconds after a command, with accelerations that it surely
/// reaches.
[[nodiscard]] Twist after(const Twist& now, const Twist& command, double time_s);

/// From a rectangle at a pose to a point, metres; 0 inside.
[[nodiscard]] double distance_to_body(const Eigen::Vector2d& p_base, const robot::Footprint& body);

/// Whether a person comes within `margin_m` of a body that is at `pose_base` (in base, now) in
/// `time_s` seconds. The person is predicted at constant velocity, and grows by its error.
[[nodiscard]] bool is_touched(const robot::Footprint& body, const geometry::SE2& pose_base,
                              const Person& person, double time_s, double margin_m);

}  // namespace nodmap::navigator
