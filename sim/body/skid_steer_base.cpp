// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/skid_steer_base.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace {

constexpr double kGravityMps2 = 9.81;
// Slip and tilt change with the ground: about half a rotation of a wheel (perimeter 0.379 m).
constexpr double kGroundLengthM = 0.2;
// Time constant with which the tyres yield and recover.
constexpr double kTiltLagS = 0.1;

}  // namespace

SkidSteerBase::SkidSteerBase(const DriveParams& params, const geometry::SE2& T_world_start,
                             std::uint64_t seed)
    : params_(params),
      T_world_base_(T_world_start),
      scales_{1.0 / (1.0 + params.odometry_scale_bias + 0.5 * params.odometry_scale_difference),
              1.0 / (1.0 + params.odometry_scale_bias - 0.5 * params.odometry_scale_difference)},
      engine_(seed),
      ground_engine_(seed + 1) {
  // A relative error with standard deviation s and correlation length L adds up to s * sqrt(2 L d)
  // over a distance d much longer than L.
  const double root = std::sqrt(2.0 * kGroundLengthM);
  slip_distance_.sigma = params.slip_distance_m / root;
  slip_heading_.sigma = params.slip_heading_rad / root;
  // The distance that the wheels move in a rotation by 1 rad on the spot.
  const double distance_per_rad_m = 0.5 * params.axis_length_m / params.turning_adaptation;
  slip_turning_.sigma =
      params.slip_turning_rad / std::sqrt(2.0 * kGroundLengthM / distance_per_rad_m);
  ground_up_.sigma = ground_left_.sigma = params.ground_tilt_rad;
}

void SkidSteerBase::set_wheel_speeds(const WheelSpeeds& goal) {
  // No wheel exceeds the top speed, neither as counted by itself nor over ground.
  const double left = params_.top_speed_mps * std::min(1.0, 1.0 / scales_.left);
  const double right = params_.top_speed_mps * std::min(1.0, 1.0 / scales_.right);
  goal_ = {std::clamp(goal.left_mps, -left, left), std::clamp(goal.right_mps, -right, right)};
  is_braking_ = false;
}

void SkidSteerBase::brake() {
  goal_ = {};
  is_braking_ = true;
}

void SkidSteerBase::step(double dt_s) {
  const WheelSpeeds before = wheels_;
  accelerate_wheel(goal_.left_mps, dt_s, wheels_.left_mps);
  accelerate_wheel(goal_.right_mps, dt_s, wheels_.right_mps);
  const double left_m = 0.5 * (before.left_mps + wheels_.left_mps) * dt_s;
  const double right_m = 0.5 * (before.right_mps + wheels_.right_mps) * dt_s;
  travel_.left_m += left_m;
  travel_.right_m += right_m;
  const double distance_m = 0.5 * (std::abs(left_m) + std::abs(right_m));
  if (distance_m > 0.0) {
    advance_random_processes(distance_m);
  }
  // Speed over ground; the mean within the step, so that distances are exact.
  const double left_mps = scales_.left * left_m / dt_s;
  const double right_mps = scales_.right * right_m / dt_s;
  const double mean_mps = 0.5 * (left_mps + right_mps);
  const double rotation_rad_s =
      (right_mps - left_mps) / params_.axis_length_m * params_.turning_adaptation;
  forward_mps_ = mean_mps * (1.0 + slip_distance_.value);
  forward_mps_ = std::clamp(forward_mps_, -params_.top_speed_mps, params_.top_speed_mps);
  yaw_rate_rad_s_ = rotation_rad_s * (1.0 + slip_turning_.value) + mean_mps * slip_heading_.value;
  move(dt_s);
  tilt(dt_s, before);
}

void SkidSteerBase::accelerate_wheel(double goal_mps, double dt_s, double& wheel_mps) const {
  // Each side moves half of the mass.
  const double cosine = 1.0 / std::hypot(1.0, slope_);
  const double friction_mps2 = params_.friction * kGravityMps2 * cosine;
  const double downhill_mps2 = kGravityMps2 * cosine * slope_;
  if (is_braking_) {
    const double uphill = wheel_mps < 0.0 ? -downhill_mps2 : downhill_mps2;
    const double slower = std::max(0.0, std::abs(wheel_mps) - (friction_mps2 + uphill) * dt_s);
    wheel_mps = std::copysign(slower, wheel_mps);
    return;
  }
  const double wanted_mps2 = (goal_mps - wheel_mps) / params_.motor_lag_s;
  double least_mps2 = -friction_mps2 - downhill_mps2;
  double most_mps2 = friction_mps2 - downhill_mps2;
  if (wanted_mps2 * wheel_mps > 0.0) {
    const double power_mps2 = params_.motor_power_w / (0.5 * params_.mass_kg * std::abs(wheel_mps));
    least_mps2 = std::max(least_mps2, -power_mps2 - downhill_mps2);
    most_mps2 = std::min(most_mps2, power_mps2 - downhill_mps2);
  }
  wheel_mps += std::clamp(wanted_mps2, least_mps2, most_mps2) * dt_s;
}

// Exact for any step: slip and tilt per metre depend neither on the speed nor on the step.
void SkidSteerBase::advance_random_processes(double distance_m) {
  const double keep = std::exp(-distance_m / kGroundLengthM);
  const double renew = std::sqrt(1.0 - keep * keep);
  for (RandomProcess* slip : {&slip_distance_, &slip_heading_, &slip_turning_}) {
    slip->value = keep * slip->value + renew * slip->sigma * normal_(engine_);
  }
  for (RandomProcess* tilt : {&ground_up_, &ground_left_}) {
    tilt->value = keep * tilt->value + renew * tilt->sigma * ground_normal_(ground_engine_);
  }
}

void SkidSteerBase::move(double dt_s) {
  const double mid_yaw_rad = T_world_base_.yaw + 0.5 * yaw_rate_rad_s_ * dt_s;
  const double seen_from_above_m = forward_mps_ * dt_s / std::hypot(1.0, slope_);
  T_world_base_.x += seen_from_above_m * std::cos(mid_yaw_rad);
  T_world_base_.y += seen_from_above_m * std::sin(mid_yaw_rad);
  T_world_base_.yaw = geometry::normalize_angle(T_world_base_.yaw + yaw_rate_rad_s_ * dt_s);
}

// Tilts the body by the wheels' acceleration, also while an obstacle blocks the robot: the motors
// press it against the obstacle.
void SkidSteerBase::tilt(double dt_s, const WheelSpeeds& before) {
  const double gain = dt_s / (kTiltLagS + dt_s);
  acceleration_mps2_ = {
      0.5 * (wheels_.left_mps - before.left_mps + wheels_.right_mps - before.right_mps) / dt_s,
      forward_mps_ * yaw_rate_rad_s_};
  tilt_up_rad_ += gain * (params_.tilt_per_mps2_rad * acceleration_mps2_.x() - tilt_up_rad_);
  // In a left curve the body tilts to the right.
  tilt_left_rad_ += gain * (-params_.tilt_per_mps2_rad * acceleration_mps2_.y() - tilt_left_rad_);
}

void SkidSteerBase::block(const geometry::SE2& T_world_base) {
  T_world_base_ = T_world_base;
  forward_mps_ = 0.0;
  yaw_rate_rad_s_ = 0.0;
  acceleration_mps2_.setZero();
}

}  // namespace nodmap::sim
