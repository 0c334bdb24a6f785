// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot_body.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace {

constexpr double kGravityMps2 = 9.81;
/// Slip changes with the ground: about half a turn of a wheel (0.379 m).
constexpr double kSlipLengthM = 0.2;
/// The tyres give way and come back within a tenth of a second.
constexpr double kLeanLagS = 0.1;

}  // namespace

RobotBody::RobotBody(const PlantParams& params, const geometry::SE2& T_world_start,
                     std::uint64_t seed)
    : params_(params), T_world_base_(T_world_start), engine_(seed) {
  // A share with deviation s that keeps its value over a length L adds up to s * sqrt(2 L w) over a
  // way w that is long beside L.
  const double root = std::sqrt(2.0 * kSlipLengthM);
  slip_distance_.sigma = params.slip_distance_m / root;
  slip_heading_.sigma = params.slip_heading_rad / root;
  // Turning by 1 rad on the spot takes the wheels this way.
  const double way_per_rad_m = 0.5 * params.axis_m / params.turning_adaptation;
  slip_turn_.sigma = params.slip_turn_rad / std::sqrt(2.0 * kSlipLengthM / way_per_rad_m);
}

void RobotBody::set_wheel_speeds(const WheelSpeeds& goal) {
  // No wheel beyond the top speed: neither as it counts itself, nor over ground.
  const double top = params_.top_speed_mps * std::min(1.0, 1.0 + params_.odometry_scale_bias);
  goal_ = {std::clamp(goal.left_mps, -top, top), std::clamp(goal.right_mps, -top, top)};
  braking_ = false;
}

void RobotBody::brake() {
  goal_ = {};
  braking_ = true;
}

void RobotBody::step(double dt_s) {
  const WheelSpeeds before = wheels_;
  turn_wheel(goal_.left_mps, dt_s, wheels_.left_mps);
  turn_wheel(goal_.right_mps, dt_s, wheels_.right_mps);
  const double left_m = 0.5 * (before.left_mps + wheels_.left_mps) * dt_s;
  const double right_m = 0.5 * (before.right_mps + wheels_.right_mps) * dt_s;
  travel_.left_m += left_m;
  travel_.right_m += right_m;
  const double way_m = 0.5 * (std::abs(left_m) + std::abs(right_m));
  if (way_m > 0.0) {
    wander(way_m);
  }
  // Over ground; the mean speed within the step, so that ways are exact.
  const double rims_mps = 0.5 * (left_m + right_m) / dt_s;
  const double turn_rad_s = (right_m - left_m) / dt_s / params_.axis_m * params_.turning_adaptation;
  forward_mps_ = rims_mps / (1.0 + params_.odometry_scale_bias) * (1.0 + slip_distance_.value);
  forward_mps_ = std::clamp(forward_mps_, -params_.top_speed_mps, params_.top_speed_mps);
  yaw_rate_rad_s_ = turn_rad_s * (1.0 + slip_turn_.value) + rims_mps * slip_heading_.value;
  move(dt_s);
  lean(dt_s, before);
}

void RobotBody::turn_wheel(double goal_mps, double dt_s, double& wheel_mps) const {
  // Each side moves half of the mass.
  const double grip_mps2 = params_.grip * kGravityMps2;
  if (braking_) {
    const double slower = std::max(0.0, std::abs(wheel_mps) - grip_mps2 * dt_s);
    wheel_mps = std::copysign(slower, wheel_mps);
    return;
  }
  const double wanted_mps2 = (goal_mps - wheel_mps) / params_.motor_lag_s;
  double most_mps2 = grip_mps2;
  if (wanted_mps2 * wheel_mps > 0.0) {
    const double power_mps2 = params_.motor_power_w / (0.5 * params_.mass_kg * std::abs(wheel_mps));
    most_mps2 = std::min(most_mps2, power_mps2);
  }
  wheel_mps += std::clamp(wanted_mps2, -most_mps2, most_mps2) * dt_s;
}

/// Ornstein-Uhlenbeck, exact for any way: the slip per way does not depend on the speed.
void RobotBody::wander(double way_m) {
  const double keep = std::exp(-way_m / kSlipLengthM);
  const double renew = std::sqrt(1.0 - keep * keep);
  for (Wander* slip : {&slip_distance_, &slip_heading_, &slip_turn_}) {
    slip->value = keep * slip->value + renew * slip->sigma * normal_(engine_);
  }
}

void RobotBody::move(double dt_s) {
  const double middle_rad = T_world_base_.yaw + 0.5 * yaw_rate_rad_s_ * dt_s;
  T_world_base_.x += forward_mps_ * dt_s * std::cos(middle_rad);
  T_world_base_.y += forward_mps_ * dt_s * std::sin(middle_rad);
  T_world_base_.yaw = geometry::normalize_angle(T_world_base_.yaw + yaw_rate_rad_s_ * dt_s);
}

/// By what the wheels do, as long as they are not held back.
void RobotBody::lean(double dt_s, const WheelSpeeds& before) {
  const double share = dt_s / (kLeanLagS + dt_s);
  const double ahead_mps2 =
      0.5 * (wheels_.left_mps - before.left_mps + wheels_.right_mps - before.right_mps) / dt_s;
  const double left_mps2 = forward_mps_ * yaw_rate_rad_s_;
  lean_up_rad_ += share * (params_.tilt_per_mps2_rad * ahead_mps2 - lean_up_rad_);
  // In a left turn the body leans to the right.
  lean_left_rad_ += share * (-params_.tilt_per_mps2_rad * left_mps2 - lean_left_rad_);
}

void RobotBody::hold_back(const geometry::SE2& T_world_base) {
  T_world_base_ = T_world_base;
  forward_mps_ = 0.0;
  yaw_rate_rad_s_ = 0.0;
}

}  // namespace nodmap::sim
