// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace nodmap::bench {

/// A sample of how the robot really moves.
struct Motion {
  std::int64_t utime_us = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
};

/// A way to standstill.
struct Stop {
  double speed_mps = 0.0;  ///< when it should have begun
  double time_s = 0.0;     ///< until it stands
  double way_m = 0.0;
  /// Beyond braking at once with `deceleration`, as the base driver's ramp does.
  [[nodiscard]] double excess_time_s(double deceleration_mps2) const {
    return time_s - speed_mps / deceleration_mps2;
  }
  [[nodiscard]] double excess_way_m(double deceleration_mps2) const {
    return way_m - speed_mps * speed_mps / (2.0 * deceleration_mps2);
  }
};

/// How the robot came to stand after `from_us`; nothing when it did not. `motions` ascend in time.
[[nodiscard]] std::optional<Stop> measure_stop(const std::vector<Motion>& motions,
                                               std::int64_t from_us);

}  // namespace nodmap::bench
