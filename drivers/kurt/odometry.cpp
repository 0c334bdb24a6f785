// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/odometry.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/kurt/encoder_clock.hpp"

namespace nodmap::kurt {
namespace {

constexpr double kPeriodS = 1e-6 * kEncoderPeriodUs;
/// A wheel in the air was measured at 7.7 m/s (data/kurt); a bit error makes more.
constexpr double kFastestWheelMps = 2.0 * kTopSpeedMps;
/// In a lost period the robot did what it did before, to about a half.
constexpr double kBridgeSigmaShare = 0.5;
/// The base stops 100 ms after it hears nothing; then the robot brakes.
constexpr double kRollOnS = 0.5;

/// sin(x) / x
double sinc(double x) {
  return std::abs(x) < 1e-6 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

double square(double x) {
  return x * x;
}

}  // namespace

bool Odometry::is_plausible(const EncoderTicks& ticks) const {
  return m_per_tick() * std::max(std::abs(ticks.left), std::abs(ticks.right)) <=
         kFastestWheelMps * kPeriodS;
}

bool Odometry::add(const EncoderTicks& ticks) {
  if (!is_plausible(ticks)) {
    bridge(1);
    return false;
  }
  const double left_m = m_per_tick() * ticks.left;
  const double right_m = m_per_tick() * ticks.right;
  const double distance_m = 0.5 * (left_m + right_m);
  const double turn_rad = (right_m - left_m) / params_.axis_m * params_.turning_adaptation;
  move(distance_m, turn_rad, 0.0);
  state_.forward_mps = distance_m / kPeriodS;
  state_.yaw_rate_rad_s = turn_rad / kPeriodS;
  return true;
}

void Odometry::bridge(int lost_frames) {
  const double duration_s = kPeriodS * lost_frames;
  move(state_.forward_mps * duration_s, state_.yaw_rate_rad_s * duration_s, kBridgeSigmaShare);
}

void Odometry::bridge_gap(double gap_s) {
  const double rolled_s = std::min(gap_s, kRollOnS);
  const double way_m = state_.forward_mps * rolled_s;
  const double turn_rad = state_.yaw_rate_rad_s * rolled_s;
  state_.covariance.diagonal() += Eigen::Vector3d(square(way_m), square(way_m), square(turn_rad));
  state_.forward_mps = 0.0;
  state_.yaw_rate_rad_s = 0.0;
}

void Odometry::move(double distance_m, double turn_rad, double sigma_share) {
  // The chord of the arc, at half the turn.
  const double chord_m = distance_m * sinc(0.5 * turn_rad);
  const double direction_rad = state_.T_odom_base.yaw + 0.5 * turn_rad;
  const double c = std::cos(direction_rad);
  const double s = std::sin(direction_rad);
  state_.T_odom_base.x += chord_m * c;
  state_.T_odom_base.y += chord_m * s;
  state_.T_odom_base.yaw = geometry::normalize_angle(state_.T_odom_base.yaw + turn_rad);

  // To first order: how the new pose depends on the old one (F), and on distance and turn (G).
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = -chord_m * s;
  F(1, 2) = chord_m * c;
  Eigen::Matrix<double, 3, 2> G;
  G << c, -0.5 * chord_m * s,  //
      s, 0.5 * chord_m * c,    //
      0.0, 1.0;
  // Slips of one period are independent of those of the next: variances grow with the way.
  const double way_m = std::abs(distance_m);
  const Eigen::Vector2d variance(
      square(params_.distance_sigma_m) * way_m + square(sigma_share * distance_m),
      square(params_.heading_sigma_rad) * way_m +
          square(params_.turn_sigma_rad) * std::abs(turn_rad) + square(sigma_share * turn_rad));
  state_.covariance =
      F * state_.covariance * F.transpose() + G * variance.asDiagonal() * G.transpose();
}

}  // namespace nodmap::kurt
