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

/// The motion of the base after a time with a command, seconds: what it does with a reserve.
[[nodiscard]] Twist after(const Twist& now, const Twist& command, double time_s);

/// From a rectangle at a pose to a point, metres; 0 inside.
[[nodiscard]] double distance_to_body(const Eigen::Vector2d& p_base, const robot::Footprint& body);

/// Whether somebody touches a body, or comes within a margin of it, that is at a pose (in base,
/// now) after a time. He goes on at his velocity, and the error of that makes him larger.
[[nodiscard]] bool is_touched(const robot::Footprint& body, const geometry::SE2& pose_base,
                              const Person& person, double time_s, double margin_m);

}  // namespace nodmap::navigator
