// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/speed_limiter.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::kurt {
namespace {

/// The share of the step from `now` to `target` that a wheel may make in one period.
double allowed_share(double now, double target, double period_s, const KurtParams& params) {
  const double step = std::abs(target - now);
  const bool gains = std::abs(target) > std::abs(now) && target * now >= 0.0;
  const double limit =
      period_s * (gains ? params.max_acceleration_mps2 : params.max_deceleration_mps2);
  return step <= limit ? 1.0 : limit / step;
}

}  // namespace

WheelSpeeds wheel_speeds(const DriveCommand& command, const KurtParams& params) {
  // Odometry turns wheels into a turn rate by (right - left) / axis * turning_adaptation; this is
  // the inverse. kurt_driver takes the whole axis on each side instead.
  const double lever_m = params.steering == Steering::kKurtDriver
                             ? params.axis_m
                             : 0.5 * params.axis_m / params.turning_adaptation;
  const double turn_mps = lever_m * command.yaw_rate_rad_s;
  return {command.forward_mps - turn_mps, command.forward_mps + turn_mps};
}

WheelSpeeds saturate(const WheelSpeeds& speeds, double max_speed_mps) {
  const double fastest = std::max(std::abs(speeds.left_mps), std::abs(speeds.right_mps));
  const double factor = fastest > max_speed_mps ? max_speed_mps / fastest : 1.0;
  return {factor * speeds.left_mps, factor * speeds.right_mps};
}

WheelSpeeds SpeedLimiter::step(const DriveCommand& target, double period_s) {
  const WheelSpeeds goal = saturate(wheel_speeds(target, params_), params_.max_speed_mps);
  // One share for both wheels, the smaller: from standstill and to standstill the robot keeps to
  // the commanded curve.
  const double share =
      std::min(allowed_share(current_.left_mps, goal.left_mps, period_s, params_),
               allowed_share(current_.right_mps, goal.right_mps, period_s, params_));
  current_.left_mps += share * (goal.left_mps - current_.left_mps);
  current_.right_mps += share * (goal.right_mps - current_.right_mps);
  return current_;
}

}  // namespace nodmap::kurt
