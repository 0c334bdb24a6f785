// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/odometry.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/kurt/encoder_clock.hpp"

namespace nodmap::kurt {
namespace {

// A wheel in the air was measured at 7.7 m/s (data/kurt); bit errors give more.
constexpr double kFastestWheelMps = 2.0 * kTopSpeedMps;
// A wheel changes its speed by no more than this in a period: 0.3 m/s are 30 m/s^2, ten times the
// deceleration that the driver commands, and a period of the base may be a tenth longer or shorter.
// SLCAN has no checksum, so a damaged digit looks like ticks; of one that is still believed, 3 mm
// remain at rest. Brakes on a hit or a wheel that loses the ground may be quicker. They are
// believed some periods later, as the permitted change grows with the time since ticks were last
// believed.
constexpr double kFastestChangeMps = 0.3;
constexpr double kFastestChangeRatio = 0.2;
// It grows no further than for a stop at once from any speed (1.3 m/s a period from 5.2 m/s), and
// for 1.5 m/s after the start: a wrong speed that is believed would be bridged for ten periods.
constexpr int kMaxPeriods = 5;
// During a lost period the robot is assumed to move as before, with a standard deviation of half
// of that motion.
constexpr double kBridgeSigmaRatio = 0.5;
// How long the robot may roll on after the base has received nothing: 100 ms until it stops the
// motors, then braking.
constexpr double kRollOnS = 0.5;

// sin(x) / x
double sinc(double x) {
  return std::abs(x) < 1e-6 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

double square(double x) {
  return x * x;
}

}  // namespace

bool Odometry::is_plausible(const EncoderTicks& ticks) const {
  if (m_per_tick() * std::max(std::abs(ticks.left), std::abs(ticks.right)) >
      kFastestWheelMps * kEncoderPeriodS) {
    return false;
  }
  return can_follow(believed_, ticks, std::min(periods_since_believed_, kMaxPeriods)) ||
         (periods_since_believed_ > kRemembered && can_follow(received_, ticks, 1));
}

// Whether both sides can have changed from `before` to `ticks` in so many periods.
bool Odometry::can_follow(const EncoderTicks& before, const EncoderTicks& ticks,
                          int periods) const {
  const auto can = [&](int from, int to) {
    const double limit_m =
        kFastestChangeMps * kEncoderPeriodS + kFastestChangeRatio * m_per_tick() * std::abs(from);
    return m_per_tick() * std::abs(to - from) <= periods * limit_m;
  };
  return can(before.left, ticks.left) && can(before.right, ticks.right);
}

void Odometry::ignore(const EncoderTicks& ticks) {
  received_ = ticks;
  ++periods_since_believed_;
}

bool Odometry::add(const EncoderTicks& ticks) {
  if (!is_plausible(ticks)) {
    received_ = ticks;
    bridge(1);
    return false;
  }
  believed_ = ticks;
  received_ = ticks;
  periods_since_believed_ = 1;
  const double left_m = m_per_tick() * ticks.left;
  const double right_m = m_per_tick() * ticks.right;
  last_motion_ = {.distance_m = 0.5 * (left_m + right_m),
                  .rotation_rad = (right_m - left_m) / wheels_.axis_m * wheels_.turning_adaptation,
                  .wheel_path_m = 0.5 * (std::abs(left_m) + std::abs(right_m))};
  move(last_motion_, 1, 0.0);
  return true;
}

void Odometry::bridge(int lost_frames) {
  periods_since_believed_ += lost_frames;
  move({.distance_m = lost_frames * last_motion_.distance_m,
        .rotation_rad = lost_frames * last_motion_.rotation_rad,
        .wheel_path_m = lost_frames * last_motion_.wheel_path_m},
       lost_frames, kBridgeSigmaRatio);
}

void Odometry::bridge_gap(double gap_s) {
  const double rolled_s = std::min(gap_s, kRollOnS);
  const double distance_m = state_.forward_mps * rolled_s;
  const double rotation_rad = state_.yaw_rate_rad_s * rolled_s;
  state_.covariance.diagonal() +=
      Eigen::Vector3d(square(distance_m), square(distance_m), square(rotation_rad));
  state_.forward_mps = 0.0;
  state_.yaw_rate_rad_s = 0.0;
  last_motion_ = {};
  believed_ = {};  // the base has stopped the motors
  periods_since_believed_ = kMaxPeriods;
  gyro_.interrupt();
}

void Odometry::move(const Motion& motion, int periods, double sigma_ratio) {
  const double distance_m = motion.distance_m;
  // The slip of one period is independent of that of the next, so variances grow with the distance.
  const double driven_m = std::abs(distance_m);
  const GyroHeading::Rotation rotation = gyro_.rotate(
      {.rotation_rad = motion.rotation_rad,
       .path_m = motion.wheel_path_m,
       .variance_rad2 = square(noise_.heading_sigma_rad) * driven_m +
                        square(noise_.rotation_sigma_rad) * std::abs(motion.rotation_rad),
       .periods = periods});
  const double rotation_rad = rotation.rotation_rad;
  state_.forward_mps = distance_m / (kEncoderPeriodS * periods);
  state_.yaw_rate_rad_s = rotation_rad / (kEncoderPeriodS * periods);

  // The chord of the arc points along the heading after half the rotation.
  const double chord_m = distance_m * sinc(0.5 * rotation_rad);
  const double direction_rad = state_.T_odom_base.yaw + 0.5 * rotation_rad;
  const double c = std::cos(direction_rad);
  const double s = std::sin(direction_rad);
  state_.T_odom_base.x += chord_m * c;
  state_.T_odom_base.y += chord_m * s;
  state_.T_odom_base.yaw = geometry::normalize_angle(state_.T_odom_base.yaw + rotation_rad);

  // First-order derivatives of the new pose with respect to the old one (F), and to distance and
  // rotation (G).
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = -chord_m * s;
  F(1, 2) = chord_m * c;
  Eigen::Matrix<double, 3, 2> G;
  G << c, -0.5 * chord_m * s,  //
      s, 0.5 * chord_m * c,    //
      0.0, 1.0;
  const Eigen::Vector2d variance(
      square(noise_.distance_sigma_m) * driven_m + square(sigma_ratio * distance_m),
      rotation.variance_rad2 + square(sigma_ratio * rotation_rad));
  state_.covariance =
      F * state_.covariance * F.transpose() + G * variance.asDiagonal() * G.transpose();
}

}  // namespace nodmap::kurt
