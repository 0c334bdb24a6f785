// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"
#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/params.hpp"
#include "drivers/kurt/speed_limiter.hpp"

namespace nodmap::kurt {

/// Why the base's own sensors stop the robot until it is released.
enum class Alarm : std::uint8_t { kBumper, kTilt, kStall };

/// The name of the sensor, for a sentence "stopped by ...".
[[nodiscard]] const char* name_of(Alarm alarm);

/// Slows or stops the robot by the base's own sensors, without laser, map or network: the last
/// protection against obstacles that the laser does not see, such as glass.
///
/// Ranges limit the speed so that, at half the deceleration that the wheels are capable of, the
/// robot can stop GuardParams::near_m before the obstacle. Nearer than that it creeps, so that it
/// can still pass where the laser sees free space. Ahead the sonar measures; the two infrared range
/// finders at the front look 45 degrees aside, so they count only if something is too near to be
/// measured, at a corner of the body. A silent sensor limits nothing, because not every KURT2 has
/// these sensors. Bumper, tilt and a stalled motor raise an alarm once; a person must release the
/// robot before it drives on. While the bumper is still touched, or the robot still tilted, it only
/// creeps, so that it can be backed off.
class BaseGuard {
 public:
  BaseGuard(const GuardParams& params, const SpeedLimits& limits)
      : params_(params), deceleration_mps2_(0.5 * limits.max_deceleration_mps2) {}

  void add(const RangeReadings& readings, time::SteadyTime now);
  void add(const Tilt& tilt, time::SteadyTime now);
  void add(const Bumpers& bumpers);
  /// Adds what the wheels did while the commanded speeds were `commanded`.
  void add(const EncoderTicks& ticks, const WheelSpeeds& commanded, time::SteadyTime now);

  /// Reduces the speed of a command to what is safe; keeps its curvature.
  [[nodiscard]] DriveCommand limit(const DriveCommand& command, time::SteadyTime now) const;

  /// The alarm since the last call, if any.
  [[nodiscard]] std::optional<Alarm> take_alarm();

  /// The alarm whose cause lasts, so that the robot only creeps, if any.
  [[nodiscard]] std::optional<Alarm> lasting_alarm() const;

 private:
  void add_sonar(int raw, time::SteadyTime now);

  /// A reading of one range finder.
  struct Seen {
    double range_m = 0.0;
    time::SteadyTime at;
  };

  /// Times a wheel that should turn and does not.
  class StallTimer {
   public:
    /// Returns for how long it has not turned.
    time::Duration add(int ticks, double commanded_mps, time::SteadyTime now);

   private:
    std::optional<time::SteadyTime> since_;
    int ticks_ = 0;  // since then
  };

  /// The greatest safe speed in the command's direction.
  [[nodiscard]] double safe_speed_mps(const DriveCommand& command, time::SteadyTime now) const;
  [[nodiscard]] double safe_speed_mps(const std::optional<Seen>& seen, time::SteadyTime now) const;

  GuardParams params_;
  double deceleration_mps2_;
  std::optional<Seen> ahead_;
  std::optional<Seen> left_corner_;
  std::optional<Seen> right_corner_;
  std::optional<Seen> behind_;
  bool is_touched_ = false;
  std::optional<time::SteadyTime> tilted_since_;
  bool is_tilted_ = false;
  StallTimer left_stall_;
  StallTimer right_stall_;
  std::optional<Alarm> alarm_;
};

}  // namespace nodmap::kurt
