// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "drivers/laser3d/nod.hpp"
#include "modules/pitch_controller/pitch_controller.hpp"

namespace nodmap::pitch_controller::test {

/// A head on a servo with a trapezoidal rate profile, controlled by the laser driver's own code.
class NoddingHead {
 public:
  double speed_gain = 1.0;  ///< a fault: the servo moves at this multiple of the commanded rate
  double short_rad = 0.0;   ///< a fault: it stops so far before its goal
  bool jammed = false;

  /// Simulates until `stamp` in steps of a millisecond; returns a reading as the driver gives it.
  PitchReading advance_to(time::Timestamp stamp) {
    for (; stamp_ < stamp; stamp_ += 1ms) {
      step(1e-3);
    }
    aim_ = nod_.step({now(), pitch_rad_, rate_rad_s_}, now());
    return {stamp_, pitch_rad_, rate_rad_s_, nod_.sweep(), nod_.is_stalled()};
  }

  void obey(const PitchDecision& decision) {
    nod_.command({decision.sweep.min_rad, decision.sweep.max_rad, decision.sweep_s}, now());
  }

  [[nodiscard]] double goal_speed_rad_s() const { return aim_.speed_rad_s; }

 private:
  [[nodiscard]] time::SteadyTime now() const { return time::SteadyTime(stamp_.time_since_epoch()); }

  static constexpr double kAccelerationRadS2 = 40.0;

  static laser3d::NodParams params() {
    laser3d::NodParams params;
    params.fallback = {-0.7, 0.26, 0.8};
    return params;
  }

  static robot::RobotParams robot() {
    robot::RobotParams robot;
    robot.head.pitch_min_rad = geometry::deg_to_rad(-60.0);
    robot.head.pitch_max_rad = geometry::deg_to_rad(60.0);
    robot.head.pitch_rate_rad_s = 3.0;
    robot.head.pitch_acceleration_rad_s2 = kAccelerationRadS2;
    return robot;
  }

  void step(double dt_s) {
    if (jammed) {
      rate_rad_s_ = 0.0;
      return;
    }
    const double left = aim_.goal_rad - pitch_rad_;
    const double to_stop = std::copysign(std::max(0.0, std::abs(left) - short_rad), left);
    const double allowed = std::min(speed_gain * aim_.speed_rad_s,
                                    std::sqrt(2.0 * kAccelerationRadS2 * std::abs(to_stop)));
    const double change = std::copysign(allowed, to_stop) - rate_rad_s_;
    rate_rad_s_ += std::clamp(change, -kAccelerationRadS2 * dt_s, kAccelerationRadS2 * dt_s);
    pitch_rad_ += rate_rad_s_ * dt_s;
  }

  laser3d::Nod nod_{params(), robot().head};
  laser3d::Nod::Aim aim_;
  time::Timestamp stamp_{};
  double pitch_rad_ = 0.0;
  double rate_rad_s_ = 0.0;
};

}  // namespace nodmap::pitch_controller::test
