// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/params.hpp"

namespace nodmap::kurt {

struct DriveCommand {
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;  ///< positive turns left
};

/// The wheel speeds that drive this command.
[[nodiscard]] WheelSpeeds wheel_speeds(const DriveCommand& command, const WheelParams& wheels);

/// Scales both speeds by the same factor if one is too fast; this keeps the curvature.
[[nodiscard]] WheelSpeeds saturate(const WheelSpeeds& speeds, double max_speed_mps);

/// Moves the wheel speeds towards the commanded ones within the acceleration limits.
class SpeedLimiter {
 public:
  SpeedLimiter(const WheelParams& wheels, const SpeedLimits& limits)
      : wheels_(wheels), limits_(limits) {}

  /// The wheel speeds for the next `period_s`.
  WheelSpeeds step(const DriveCommand& target, double period_s);

  /// Goes on from this measured motion, but not faster than in the last step.
  void start_from(const DriveCommand& motion);

  /// Sets both speeds to zero at once: a safety stop is not limited.
  void stop() { current_ = {}; }

  [[nodiscard]] const WheelSpeeds& current() const { return current_; }

 private:
  WheelParams wheels_;
  SpeedLimits limits_;
  WheelSpeeds current_;
};

}  // namespace nodmap::kurt
