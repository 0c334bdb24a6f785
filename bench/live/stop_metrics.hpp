// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::bench {

/// The robot's true motion at one moment.
struct Motion {
  time::Timestamp stamp{};
  double x_m = 0.0;
  double y_m = 0.0;
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
};

/// How fast the robot stopped.
struct StopMetrics {
  double speed_mps = 0.0;  ///< speed at the moment it should have begun to brake
  double time_s = 0.0;     ///< from that moment until it is stationary
  double distance_m = 0.0;
  /// Time beyond that of braking immediately with `deceleration`, as the base driver's ramp does.
  [[nodiscard]] double excess_time_s(double deceleration_mps2) const {
    return time_s - speed_mps / deceleration_mps2;
  }
  [[nodiscard]] double excess_distance_m(double deceleration_mps2) const {
    return distance_m - speed_mps * speed_mps / (2.0 * deceleration_mps2);
  }
};

/// How the robot stopped after `from`; nothing if it did not. `motions` in ascending order of time.
[[nodiscard]] std::optional<StopMetrics> stop_metrics(const std::vector<Motion>& motions,
                                                      time::Timestamp from);

}  // namespace nodmap::bench
