// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/params.hpp"
#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// Fewest and most scans in a sweep (paper, IV B).
inline constexpr double kFewestScans = 15.0;
inline constexpr double kMostScans = 500.0;

/// The sweep that suits a speed.
struct SweepPlan {
  double d_min_m = 0.0;  ///< ahead of the front: the corridor is covered from here on
  PitchInterval area;    ///< of interest
  PitchInterval sweep;   ///< the area and one line beyond at both ends, as the mechanics allow
  double line_spacing_rad = 0.0;  ///< from one scan to the next, at most
  double sweep_s = 0.0;           ///< T*: the shortest duration of `sweep`

  double fastest_s = 0.0;  ///< duration of `sweep` at the head's fastest,
  double slowest_s = 0.0;  ///< and at 0.25 degrees a scan, or 500 scans
};

/// The angle between scans that puts `lines` of them on an upright obstacle of this height:
/// neighbouring lines lie dp (d^2 + h^2) / d apart at distance d from the axis, which is h above
/// the floor.
[[nodiscard]] double spacing_for(double obstacle_m, int lines, double distance_m,
                                 double axis_height_m);

/// Plans sweeps by the stopping distance: at its end an obstacle must be hit by at least one line.
/// One that appears there just after the laser has passed is hit a period, 2 T, later, when the
/// robot is nearer by that much: from there on,
///
///     d_min = v T_processing + v^2 / 2a + margin,
///
/// the corridor is looked at from bottom to top, with two lines on the smallest obstacle. The sweep
/// takes as short as head and line spacing allow.
class SweepPlanner {
 public:
  SweepPlanner(const robot::RobotParams& robot, const DetectionParams& detection, double fast_mps);

  /// For a forward speed in metres per second, >= 0.
  [[nodiscard]] SweepPlan plan(double forward_mps) const;

 private:
  [[nodiscard]] SweepPlan plan_from(double stopping_distance_m, double forward_mps) const;
  [[nodiscard]] double line_spacing_rad(double d_min_m, double stopping_distance_m) const;

  robot::RobotParams robot_;
  DetectionParams detection_;
  double fast_mps_;
  VirtualCorridor corridor_;
};

}  // namespace nodmap::pitch_controller
