// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/pitch_servo.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace {

double limited(double wanted, double limit) {
  return wanted > 0.0 ? std::min(wanted, limit) : limit;
}

double sign(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

}  // namespace

PitchServo::PitchServo(const ServoParams& params) : params_(params) {}

PitchState PitchServo::at(double time_s) const {
  std::size_t i = num_pieces_ - 1;
  while (i > 0 && pieces_[i].start_s > time_s) {
    --i;
  }
  const Piece& piece = pieces_[i];
  const double t = std::max(0.0, time_s - piece.start_s);
  const double rate = piece.rate_rad_s + piece.acceleration_rad_s2 * t;
  return {piece.pitch_rad + 0.5 * (piece.rate_rad_s + rate) * t, rate};
}

void PitchServo::set_goal(const PitchGoal& goal, double time_s) {
  if (!has_torque_) {
    return;
  }
  goal_ = goal;
  goal_.pitch_rad = std::clamp(goal.pitch_rad, -params_.pitch_limit_rad, params_.pitch_limit_rad);
  plan_goal(time_s);
}

void PitchServo::set_torque(bool on, double time_s) {
  if (on == has_torque_) {
    return;
  }
  has_torque_ = on;
  plan_stop(time_s);
}

void PitchServo::set_jammed(bool jammed, double time_s) {
  if (jammed == is_jammed_) {
    return;
  }
  const PitchState state = at(time_s);
  is_jammed_ = jammed;
  restart(time_s, {state.pitch_rad, 0.0});
  plan_goal(time_s);
}

void PitchServo::plan_goal(double time_s) {
  if (is_jammed_) {
    return;
  }
  const double a = limited(goal_.acceleration_rad_s2, params_.acceleration_rad_s2);
  const double v_max = limited(goal_.speed_rad_s, params_.speed_rad_s);
  PitchState state = at(time_s);
  restart(time_s, state);
  // First stop, if it moves in the wrong direction or cannot stop before the goal.
  const double to_rest_s = std::abs(state.rate_rad_s) / a;
  const double rest_rad = state.pitch_rad + 0.5 * state.rate_rad_s * to_rest_s;
  if ((goal_.pitch_rad - rest_rad) * state.rate_rad_s < 0.0) {
    append(-sign(state.rate_rad_s) * a, to_rest_s);
    state = {rest_rad, 0.0};
  }
  const double distance = goal_.pitch_rad - state.pitch_rad;
  const double direction = sign(distance);
  const double v0 = std::abs(state.rate_rad_s);
  // Accelerate (or decelerate, if the limit has been lowered), move at constant rate, decelerate.
  const double v = std::min(v_max, std::sqrt(a * std::abs(distance) + 0.5 * v0 * v0));
  const double ramp_s = std::abs(v - v0) / a;
  const double ramp_rad = 0.5 * (v0 + v) * ramp_s;
  const double even_rad = std::abs(distance) - ramp_rad - 0.5 * v * v / a;
  append(direction * sign(v - v0) * a, ramp_s);
  append(0.0, v > 0.0 ? std::max(0.0, even_rad / v) : 0.0);
  append(-direction * a, v / a);
  pieces_[num_pieces_ - 1] = {pieces_[num_pieces_ - 1].start_s, goal_.pitch_rad, 0.0, 0.0};
}

void PitchServo::plan_stop(double time_s) {
  const PitchState state = at(time_s);
  restart(time_s, state);
  append(-sign(state.rate_rad_s) * params_.acceleration_rad_s2,
         std::abs(state.rate_rad_s) / params_.acceleration_rad_s2);
  Piece& last = pieces_[num_pieces_ - 1];
  last.rate_rad_s = 0.0;
  goal_ = {last.pitch_rad, 0.0, 0.0};
}

void PitchServo::restart(double time_s, const PitchState& state) {
  num_pieces_ = 1;
  pieces_[0] = {time_s, state.pitch_rad, state.rate_rad_s, 0.0};
}

// Sets the acceleration of the last piece, and starts the next one at its end.
void PitchServo::append(double acceleration_rad_s2, double duration_s) {
  pieces_[num_pieces_ - 1].acceleration_rad_s2 = acceleration_rad_s2;
  const double end_s = pieces_[num_pieces_ - 1].start_s + duration_s;
  ++num_pieces_;
  pieces_[num_pieces_ - 1].start_s = end_s;
  const Piece& ended = pieces_[num_pieces_ - 2];
  const double rate = ended.rate_rad_s + acceleration_rad_s2 * duration_s;
  pieces_[num_pieces_ - 1].pitch_rad =
      ended.pitch_rad + 0.5 * (ended.rate_rad_s + rate) * duration_s;
  pieces_[num_pieces_ - 1].rate_rad_s = rate;
}

}  // namespace nodmap::sim
