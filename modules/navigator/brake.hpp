// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::navigator {

/// What limits the forward speed, and what the wheels can do.
struct SpeedLimits {
  double max_forward_mps = 0.0;  ///< by parameter and by the pitch controller
  double max_yaw_rate_rad_s = 0.0;
  double max_lateral_mps2 = 0.0;
};

/// The fastest forward speed on an arc (1/m) within the limits: |v curvature| <= turn rate and
/// v |v curvature| <= lateral acceleration.
[[nodiscard]] double speed_on_arc(double curvature, const SpeedLimits& limits);

}  // namespace nodmap::navigator
