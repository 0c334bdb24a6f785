// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/twist.hpp"

#include <algorithm>

namespace nodmap::navigator {
namespace {

constexpr double kAccelerationMps2 = 1.5;
constexpr double kYawAccelerationRadS2 = 6.0;

double approach(double from, double to, double most) {
  return from + std::clamp(to - from, -most, most);
}

}  // namespace

Twist after(const Twist& now, const Twist& command, double time_s) {
  return {approach(now.forward_mps, command.forward_mps, time_s * kAccelerationMps2),
          approach(now.yaw_rate_rad_s, command.yaw_rate_rad_s, time_s * kYawAccelerationRadS2)};
}

}  // namespace nodmap::navigator
