// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/time.hpp"
#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/params.hpp"
#include "drivers/kurt/speed_limiter.hpp"

namespace nodmap::kurt {

/// Why the base's own senses stop the robot until it is told to go.
enum class Alarm { kBumper, kTilt, kStall };

/// In words, for people.
[[nodiscard]] const char* name_of(Alarm alarm);

/// What the base senses by itself, without laser, map and network: the last that keeps the robot
/// from pushing against what the laser does not see, glass for one.
///
/// Ranges slow it: it could stop 0.25 m before what is seen, at half the deceleration of which the
/// wheels are capable, and creeps from there on, so that it gets through where the laser sees a
/// way. A silent sensor slows nothing: not every KURT2 has them. Bumper, tilt and stalled motors
/// raise an alarm, once: somebody has to look before it drives on.
class BaseGuard {
 public:
  BaseGuard(const GuardParams& params, const SpeedLimits& limits)
      : params_(params), deceleration_mps2_(0.5 * limits.max_deceleration_mps2) {}

  void add(const RangeReadings& readings, time::SteadyTime now);
  void add(const Tilt& tilt, time::SteadyTime now);
  void add(const Bumpers& bumpers);
  /// What the wheels did while they were told to run at `commanded`.
  void add(const EncoderTicks& ticks, const WheelSpeeds& commanded, time::SteadyTime now);

  /// No faster towards what is near than is safe; the curvature stays.
  [[nodiscard]] DriveCommand limit(const DriveCommand& command, time::SteadyTime now) const;

  /// The alarm since the last call, if any.
  [[nodiscard]] std::optional<Alarm> take_alarm();

 private:
  /// What one range finder sees.
  struct Seen {
    double range_m = 0.0;
    time::SteadyTime at;
  };

  [[nodiscard]] double safe_speed_mps(const std::optional<Seen>& seen, time::SteadyTime now) const;

  GuardParams params_;
  double deceleration_mps2_;
  std::optional<Seen> ahead_;
  std::optional<Seen> behind_;
  std::optional<time::SteadyTime> tilted_since_;
  std::optional<time::SteadyTime> stalled_since_;
  std::optional<Alarm> alarm_;
};

}  // namespace nodmap::kurt
