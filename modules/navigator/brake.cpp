// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/brake.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::navigator {

double speed_on_arc(double curvature, const SpeedLimits& limits) {
  const double bend = std::abs(curvature);
  double speed_mps = std::max(0.0, limits.max_forward_mps);
  if (bend > 0.0) {
    speed_mps = std::min(
        {speed_mps, limits.max_yaw_rate_rad_s / bend, std::sqrt(limits.max_lateral_mps2 / bend)});
  }
  return speed_mps;
}

}  // namespace nodmap::navigator
