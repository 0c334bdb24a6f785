// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace nodmap::pitch_controller {

/// The pitch servo: even speed between the ends, even acceleration at them.
struct Servo {
  double max_speed_rad_s = 1.0;
  double acceleration_rad_s2 = 1.0;

  /// From one end to the other, half a turn at each included. The laser driver solves the same
  /// equation for the speed.
  [[nodiscard]] double sweep_s(double range_rad, double speed_rad_s) const {
    return range_rad / speed_rad_s + speed_rad_s / acceleration_rad_s2;
  }

  /// The speed of the shortest sweep: beyond sqrt(range * acceleration) turning takes longer than
  /// the way gets shorter.
  [[nodiscard]] double best_speed_rad_s(double range_rad) const {
    return std::min(max_speed_rad_s, std::sqrt(range_rad * acceleration_rad_s2));
  }
};

}  // namespace nodmap::pitch_controller
