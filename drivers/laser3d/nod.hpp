// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/angle.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/robot_params.hpp"
#include "drivers/laser3d/servo/session.hpp"

namespace nodmap::laser3d {

/// The pitches between which the laser nods, and the duration of a sweep.
struct AreaOfInterest {
  double min_rad = 0.0;  ///< positive looks up
  double max_rad = 0.0;  ///< if equal to min_rad, the laser is held there
  double sweep_s = 1.0;
};

struct NodParams {
  /// The area without a command, or when the last command is too old.
  AreaOfInterest fallback{.min_rad = geometry::deg_to_rad(-40.0),
                          .max_rad = geometry::deg_to_rad(15.0),
                          .sweep_s = 0.8};
  double command_timeout_s = 1.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("default_min_deg", fallback.min_rad, {-90.0, 90.0},
            "Lower end of the sweep without PITCH_COMMAND.");
    v.angle("default_max_deg", fallback.max_rad, {-90.0, 90.0},
            "Upper end of the sweep without PITCH_COMMAND; if equal to the lower end, the laser is "
            "held there.");
    v.number("default_sweep_s", fallback.sweep_s, {0.1, 60.0},
             "Sweep duration without PITCH_COMMAND.");
    v.number("command_timeout_s", command_timeout_s, {0.1, 10.0},
             "A PITCH_COMMAND older than this is no longer obeyed.");
  }
};

/// Moves the head back and forth between two pitches at constant speed, without stopping at the
/// ends. It reverses when the measured pitch reaches the end, not at a computed time.
class Nod {
 public:
  struct Aim {
    double goal_rad = 0.0;
    double speed_rad_s = 0.0;
  };

  Nod(const NodParams& params, const robot::HeadLimits& head) : params_(params), head_(head) {}

  /// Nods over `area`, as decided at `decided`, until another command or until this one is too old.
  /// Limits it to what the mechanics can do. Returns false and changes nothing if it is invalid:
  /// not finite, min above max, or a sweep of more than an hour.
  bool command(const AreaOfInterest& area, time::SteadyTime decided);

  /// The goal and speed for the servo, given the measured pitch.
  [[nodiscard]] Aim step(const PitchSample& where, time::SteadyTime now);

  /// Whether the head does not move although commanded to. Detected within 115 ms.
  [[nodiscard]] bool is_stalled() const { return is_stalled_; }
  /// The period of the nod, two sweeps; 0 when the laser is held.
  [[nodiscard]] time::Duration nod_period(time::SteadyTime now) const;
  /// The number of the present sweep; it increases at each end. When a stalled head reverses, the
  /// number stays: the map server counts sweeps to tell how often each direction has been seen.
  [[nodiscard]] std::int64_t sweep() const { return sweep_; }
  [[nodiscard]] const Aim& aim() const { return aim_; }

 private:
  [[nodiscard]] AreaOfInterest area(time::SteadyTime now) const;
  [[nodiscard]] AreaOfInterest within_limits(AreaOfInterest area) const;
  [[nodiscard]] bool has_arrived(const PitchSample& where, const AreaOfInterest& area) const;
  void watch_for_stall(const PitchSample& where);
  /// How long the head may stay within a quarter of a degree: twice the time needed for that angle,
  /// the reversal at an end, and a reserve.
  [[nodiscard]] time::Duration patience(const PitchSample& where) const;
  [[nodiscard]] double reversal_s(double speed_rad_s) const;
  void reverse(time::SteadyTime stamp);

  NodParams params_;
  robot::HeadLimits head_;
  std::optional<AreaOfInterest> commanded_;
  time::SteadyTime decided_;
  bool is_upwards_ = true;
  Aim aim_;
  std::int64_t sweep_ = 0;
  time::SteadyTime reversed_;
  bool nods_ = false;
  std::optional<PitchSample> moved_;  // the head's position when it last had moved
  time::SteadyTime last_stamp_;
  bool is_stalled_ = false;
};

}  // namespace nodmap::laser3d
