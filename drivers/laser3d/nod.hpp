// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/angle.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/robot_params.hpp"
#include "drivers/laser3d/servo/session.hpp"

namespace nodmap::laser3d {

/// Between which pitches the laser is to nod, and how long from one to the other.
struct AreaOfInterest {
  double min_rad = 0.0;  ///< positive looks up
  double max_rad = 0.0;  ///< equal to min_rad: the laser is held there
  double sweep_s = 1.0;
};

struct NodParams {
  /// Where to nod while nobody commands, or when the last command is too old.
  AreaOfInterest fallback{.min_rad = geometry::deg_to_rad(-40.0),
                          .max_rad = geometry::deg_to_rad(15.0),
                          .sweep_s = 0.8};
  double command_timeout_s = 1.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("default_min_deg", fallback.min_rad, {-90.0, 90.0},
            "Lower end of the sweep while nobody commands.");
    v.angle("default_max_deg", fallback.max_rad, {-90.0, 90.0},
            "Upper end of the sweep while nobody commands; equal to the lower: held there.");
    v.number("default_sweep_s", fallback.sweep_s, {0.1, 60.0},
             "Time from one end to the other while nobody commands.");
    v.number("command_timeout_s", command_timeout_s, {0.1, 10.0},
             "A PITCH_COMMAND older than this counts no more.");
  }
};

/// Moves the head to and fro between two pitches at constant speed, without a stop at the ends. It
/// reverses where the laser is measured to have arrived, not where it should be by now.
class Nod {
 public:
  struct Aim {
    double goal_rad = 0.0;
    double speed_rad_s = 0.0;
  };

  /// `robot` says what the mechanics can do: pitch limits, rate and acceleration.
  Nod(const NodParams& params, const robot::RobotParams& robot) : params_(params), robot_(robot) {}

  /// Nods over `area` from now on, until another command comes or this one is too old. What the
  /// mechanics cannot do is cut off. False, and nothing changes, when it is no area: not finite, or
  /// min above max.
  bool command(const AreaOfInterest& area, time::SteadyTime now);

  /// Where to go, given where the laser is.
  [[nodiscard]] Aim step(const PitchSample& where, time::SteadyTime now);

  /// Whether the head was told to move and does not. Known within 130 ms at the speeds of a robot
  /// that drives (up to 1 rad/s), within 220 ms at 3 rad/s.
  [[nodiscard]] bool stalled() const { return stalled_; }
  /// How long a nod takes, to the other end and back; 0 when the laser is held.
  [[nodiscard]] time::Duration nod_period(time::SteadyTime now) const;
  /// Counts the sweeps, each from one end to the other: odd ones run against even ones.
  [[nodiscard]] std::int64_t sweep() const { return sweep_; }
  [[nodiscard]] const Aim& aim() const { return aim_; }

 private:
  [[nodiscard]] AreaOfInterest area(time::SteadyTime now) const;
  [[nodiscard]] AreaOfInterest within_limits(AreaOfInterest area) const;
  [[nodiscard]] double speed_for(const AreaOfInterest& area) const;
  [[nodiscard]] bool has_arrived(const PitchSample& where, const AreaOfInterest& area) const;
  void watch_for_stall(const PitchSample& where);
  /// How long the head may stay within half a degree: twice what that takes, the reversal at an
  /// end, a reserve.
  [[nodiscard]] time::Duration patience(const PitchSample& where) const;
  void reverse(time::SteadyTime stamp);

  NodParams params_;
  robot::RobotParams robot_;
  std::optional<AreaOfInterest> commanded_;
  time::SteadyTime commanded_at_;
  bool upwards_ = true;
  Aim aim_;
  std::int64_t sweep_ = 0;
  time::SteadyTime reversed_;
  bool nods_ = false;
  std::optional<PitchSample> moved_;  // where the head was when it last had moved
  time::SteadyTime last_stamp_;
  bool stalled_ = false;
};

}  // namespace nodmap::laser3d
