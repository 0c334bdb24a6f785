// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>

#include "modules/navigator/reason.hpp"

namespace nodmap::navigator {

enum class Behaviour : std::uint8_t { kSteer, kBrake, kTurn, kArrived, kHalt };

/// What the robot is to do, and why.
struct Decision {
  Behaviour behaviour = Behaviour::kHalt;
  Reason reason;
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double steering_angle_rad = 0.0;
  double free_distance_m = 0.0;  ///< in the virtual corridor ahead; +infinity if it is empty
  double max_forward_mps = 0.0;  ///< the greatest that the limits and the free distance allow
};

/// A decision not to move.
[[nodiscard]] inline Decision stationary(Reason reason) {
  Decision decision;
  decision.behaviour = Behaviour::kBrake;
  decision.reason = std::move(reason);
  return decision;
}

/// A decision not to move because the robot must not drive.
[[nodiscard]] inline Decision halted(Reason reason) {
  Decision decision = stationary(std::move(reason));
  decision.behaviour = Behaviour::kHalt;
  return decision;
}

/// A decision to drive backwards at `speed_mps` on an arc.
[[nodiscard]] inline Decision backing(double speed_mps, double curvature, Reason reason) {
  Decision decision;
  decision.behaviour = Behaviour::kTurn;
  decision.reason = std::move(reason);
  decision.forward_mps = -speed_mps;
  decision.yaw_rate_rad_s = -speed_mps * curvature;
  return decision;
}

}  // namespace nodmap::navigator
