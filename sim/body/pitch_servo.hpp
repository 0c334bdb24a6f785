// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "sim/body/params.hpp"

namespace nodmap::sim {

/// A goal with the limits of a Dynamixel's profile; 0 means no limit.
struct PitchGoal {
  double pitch_rad = 0.0;
  double speed_rad_s = 0.0;
  double acceleration_rad_s2 = 0.0;
};

struct PitchState {
  double pitch_rad = 0.0;
  double rate_rad_s = 0.0;
};

/// The servo that pitches the scanner. It follows a trapezoidal speed profile exactly, from its
/// present state: each goal gives a few pieces of constant acceleration. Times are in seconds and
/// must not decrease.
class PitchServo {
 public:
  explicit PitchServo(const ServoParams& params);

  [[nodiscard]] PitchState at(double time_s) const;

  /// Sets the goal; ignored while the torque is off, as in the real device.
  void set_goal(const PitchGoal& goal, double time_s);
  /// Switches the torque. Off: the balanced laser comes to rest and stays there. On: it stays until
  /// the next goal.
  void set_torque(bool on, double time_s);
  /// Jams the gear, which stops at once, or frees it, after which it continues to its goal.
  void set_jammed(bool jammed, double time_s);

 private:
  struct Piece {
    double start_s = 0.0;
    double pitch_rad = 0.0;
    double rate_rad_s = 0.0;
    double acceleration_rad_s2 = 0.0;
  };

  void plan_goal(double time_s);
  void plan_stop(double time_s);
  void restart(double time_s, const PitchState& state);
  void append(double acceleration_rad_s2, double duration_s);

  ServoParams params_;
  PitchGoal goal_;
  bool has_torque_ = true;
  bool is_jammed_ = false;
  // Each piece ends where the next begins; the last one ends at rest.
  std::array<Piece, 6> pieces_{};
  std::size_t num_pieces_ = 1;
};

}  // namespace nodmap::sim
