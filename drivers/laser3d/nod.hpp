// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/laser3d/servo_session.hpp"

namespace nodmap::laser3d {

/// Between which pitches the laser is to nod, and how long from one to the other.
struct AreaOfInterest {
  double min_rad = 0.0;  ///< positive looks up
  double max_rad = 0.0;  ///< equal to min_rad: the laser is held there
  double sweep_s = 1.0;
};

struct NodSettings {
  AreaOfInterest fallback;  ///< when nobody commands, or the command is old
  double min_rad = 0.0;     ///< the mechanics
  double max_rad = 0.0;
  double max_speed_rad_s = 1.0;
  double acceleration_rad_s2 = 1.0;
  std::int64_t command_timeout_us = 1'000'000;
};

/// The movement of the head: to and fro between two pitches at constant speed, without a stop at
/// the ends. It turns where the laser is measured to have arrived, not where it should be by now.
class Nod {
 public:
  struct Aim {
    double goal_rad = 0.0;
    double speed_rad_s = 0.0;
  };

  explicit Nod(const NodSettings& settings) : settings_(settings) {}

  /// A command holds from now until another comes or it is too old. What the mechanics cannot do is
  /// cut off. False, and nothing changes, when it is no area: not finite, or min above max.
  bool command(const AreaOfInterest& area, std::int64_t now_us);

  /// Where to go, given where the laser is.
  [[nodiscard]] Aim step(const PitchSample& where, std::int64_t now_us);

  /// Whether it was told to move and does not; known within 130 ms at the speeds of a robot that
  /// drives (up to 1 rad/s), within 220 ms at 3 rad/s.
  [[nodiscard]] bool stalled() const { return stalled_; }
  /// How long a nod takes, to the other end and back; of a laser that is held, no time.
  [[nodiscard]] std::int64_t nod_us(std::int64_t now_us) const;
  /// Counts the turns at the ends: sweep n runs the other way than sweep n + 1.
  [[nodiscard]] std::int64_t sweep() const { return sweep_; }
  [[nodiscard]] const Aim& aim() const { return aim_; }

 private:
  [[nodiscard]] AreaOfInterest area(std::int64_t now_us) const;
  [[nodiscard]] AreaOfInterest within_limits(AreaOfInterest area) const;
  [[nodiscard]] double speed_for(const AreaOfInterest& area) const;
  [[nodiscard]] bool has_arrived(const PitchSample& where, const AreaOfInterest& area) const;
  void watch_for_stall(const PitchSample& where);
  /// How long it may stay within half a degree: twice what that takes, the turn at an end, a
  /// reserve.
  [[nodiscard]] std::int64_t patience_us(const PitchSample& where) const;
  void turn(std::int64_t time_us);

  NodSettings settings_;
  std::optional<AreaOfInterest> commanded_;
  std::int64_t commanded_us_ = 0;
  bool upwards_ = true;
  Aim aim_;
  std::int64_t sweep_ = 0;
  std::int64_t turned_us_ = 0;
  bool nods_ = false;
  std::optional<PitchSample> moved_;  // where it was when it last had moved
  std::int64_t last_us_ = 0;
  bool stalled_ = false;
};

}  // namespace nodmap::laser3d
