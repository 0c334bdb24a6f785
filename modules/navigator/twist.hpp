// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// A motion of base: forward speed and yaw rate.
struct Twist {
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;

  [[nodiscard]] Twist scaled(double factor) const {
    return {factor * forward_mps, factor * yaw_rate_rad_s};
  }
};

/// The motion of the base `time_s` seconds after a command.
[[nodiscard]] Twist after(const Twist& now, const Twist& command, double time_s,
                          const BaseParams& base);

}  // namespace nodmap::navigator
