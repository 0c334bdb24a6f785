// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/twist.hpp"

#include <algorithm>

namespace nodmap::navigator {
namespace {

double approach(double from, double to, double most) {
  return from + std::clamp(to - from, -most, most);
}

}  // namespace

Twist after(const Twist& now, const Twist& command, double time_s, const BaseParams& base) {
  return {
      approach(now.forward_mps, command.forward_mps, time_s * base.acceleration_mps2),
      approach(now.yaw_rate_rad_s, command.yaw_rate_rad_s, time_s * base.yaw_acceleration_rad_s2)};
}

}  // namespace nodmap::navigator
