// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/servo.hpp"
#include "modules/pitch_controller/stopping.hpp"
#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// The nod that suits a speed.
struct SweepPlan {
  double d_min_m = 0.0;  ///< ahead of the front: the corridor is covered from here on
  PitchInterval area;    ///< of interest (R10)
  PitchInterval sweep;   ///< the area and a line beyond at both ends, as the mechanics allow
  double line_spacing_rad = 0.0;  ///< at most, from one scan to the next
  double sweep_s = 0.0;           ///< T*: the shortest time for `sweep`

  double fastest_s = 0.0;  ///< what the servo can do at all with `sweep`,
  double slowest_s = 0.0;  ///< and with 0.25 degrees a scan and 500 scans (R11, R12)
};

/// Pitches that are resolved finely enough for obstacles of `obstacle_m` at `distance_m` from the
/// axis: neighbouring lines lie dp (d^2 + h^2) / d apart on what stands upright there.
[[nodiscard]] double spacing_for(double obstacle_m, int lines, double distance_m, double lever_m);

/// Plans by the stopping way, v T_w + v^2 / 2a + margin: an obstacle there has to be met by a line.
/// What appears there just after the laser has passed is met a period, 2 T_h, later and nearer by
/// that way: from there on, d_min = v T_proc + v^2 / 2a + margin, the corridor is looked at as a
/// whole, with two lines on the smallest obstacle. The sweep is as short as servo and lines allow.
class SweepPlanner {
 public:
  explicit SweepPlanner(const PitchControllerParams& params);

  /// For a forward speed in metres per second, >= 0.
  [[nodiscard]] SweepPlan plan(double forward_mps) const;

 private:
  [[nodiscard]] SweepPlan plan_from(double stopping_way_m, double forward_mps) const;

  PitchControllerParams params_;
  VirtualCorridor corridor_;
  Stopping stopping_;
  Servo servo_;
};

}  // namespace nodmap::pitch_controller
