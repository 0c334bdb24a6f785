// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/speed_limiter.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::kurt {
namespace {

// The fraction of the step from `now` to `target` that a wheel may make in one period.
double allowed_fraction(double now, double target, double period_s, const SpeedLimits& limits) {
  const double step = std::abs(target - now);
  const bool gains = std::abs(target) > std::abs(now) && target * now >= 0.0;
  const double limit =
      period_s * (gains ? limits.max_acceleration_mps2 : limits.max_deceleration_mps2);
  return step <= limit ? 1.0 : limit / step;
}

// The moment arm of a wheel by which odometry measures a rotation.
double odometry_arm_m(const WheelParams& wheels) {
  return 0.5 * wheels.axis_m / wheels.turning_adaptation;
}

WheelSpeeds speeds_at(double moment_arm_m, const DriveCommand& motion) {
  const double rotation_mps = moment_arm_m * motion.yaw_rate_rad_s;
  return {motion.forward_mps - rotation_mps, motion.forward_mps + rotation_mps};
}

double fastest(const WheelSpeeds& speeds) {
  return std::max(std::abs(speeds.left_mps), std::abs(speeds.right_mps));
}

}  // namespace

WheelSpeeds wheel_speeds(const DriveCommand& command, const WheelParams& wheels) {
  // Inverse of the odometry's yaw rate, (right - left) / axis * turning_adaptation. kurt_driver
  // uses the whole axis on each side instead.
  return speeds_at(
      wheels.steering == Steering::kKurtDriver ? wheels.axis_m : odometry_arm_m(wheels), command);
}

WheelSpeeds saturate(const WheelSpeeds& speeds, double max_speed_mps) {
  const double speed_mps = fastest(speeds);
  const double factor = speed_mps > max_speed_mps ? max_speed_mps / speed_mps : 1.0;
  return {factor * speeds.left_mps, factor * speeds.right_mps};
}

void SpeedLimiter::start_from(const DriveCommand& motion) {
  current_ = saturate(speeds_at(odometry_arm_m(wheels_), motion), fastest(current_));
}

WheelSpeeds SpeedLimiter::step(const DriveCommand& target, double period_s) {
  const WheelSpeeds goal = saturate(wheel_speeds(target, wheels_), limits_.max_speed_mps);
  // Uses the smaller of the two fractions for both wheels, so that the robot follows the commanded
  // curve also when it starts and stops.
  const double fraction =
      std::min(allowed_fraction(current_.left_mps, goal.left_mps, period_s, limits_),
               allowed_fraction(current_.right_mps, goal.right_mps, period_s, limits_));
  current_.left_mps += fraction * (goal.left_mps - current_.left_mps);
  current_.right_mps += fraction * (goal.right_mps - current_.right_mps);
  return current_;
}

}  // namespace nodmap::kurt
