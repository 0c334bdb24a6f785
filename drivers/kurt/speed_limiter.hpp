// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/params.hpp"

namespace nodmap::kurt {

struct DriveCommand {
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;  ///< positive turns left
};

/// The wheel speeds that drive this command.
[[nodiscard]] WheelSpeeds wheel_speeds(const DriveCommand& command, const KurtParams& params);

/// Slower by the same factor on both sides where one is too fast: the curvature stays.
[[nodiscard]] WheelSpeeds saturate(const WheelSpeeds& speeds, double max_speed_mps);

/// Leads the wheels from what they do to what they should do, within the robot's limits.
class SpeedLimiter {
 public:
  explicit SpeedLimiter(KurtParams params) : params_(std::move(params)) {}

  /// The wheel speeds for the next `period_s`.
  WheelSpeeds step(const DriveCommand& target, double period_s);

  /// Zero, at once: for safety, without limit.
  void stop() { current_ = {}; }

  [[nodiscard]] const WheelSpeeds& current() const { return current_; }

 private:
  KurtParams params_;
  WheelSpeeds current_;
};

}  // namespace nodmap::kurt
