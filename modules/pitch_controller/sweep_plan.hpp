// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "modules/pitch_controller/params.hpp"
#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// Fewest and most scans in a sweep (paper, IV B).
inline constexpr double kMinScans = 15.0;
inline constexpr double kMaxScans = 500.0;

/// The planned sweep for a speed.
struct SweepPlan {
  double d_min_m = 0.0;  ///< distance ahead of the front beyond which the corridor is covered
  PitchInterval area;    ///< area of interest
  /// The area and one line more at both ends, within the mechanical range. From 1.2 m/s on it ends
  /// lower, so that the floor is seen densely.
  PitchInterval sweep;
  double line_spacing_rad = 0.0;  ///< largest permitted angle between neighbouring scans
  NodMotion nod;                  ///< the head's motion in such sweeps
  double sweep_s = 0.0;           ///< T_sweep: the shortest duration of `sweep`

  double fastest_s = 0.0;  ///< duration of `sweep` at the head's highest rate
  double slowest_s = 0.0;  ///< duration of `sweep` at 0.25 degrees per scan, at most 500 scans
};

/// What the robot needs to see ahead, beside what may appear; metres ahead of the front.
struct NeededView {
  /// It cannot use what is farther away, such as what is behind the first obstacle.
  double used_m = std::numeric_limits<double>::infinity();
  /// The sweep covers the floor beyond this distance; infinite: none.
  double floor_from_m = std::numeric_limits<double>::infinity();
};

/// The angle dp between scans at which `lines` scan lines hit an upright obstacle of height
/// `obstacle_m` at distance `distance_m` from the pitch axis: at distance d neighbouring lines are
/// dp (d^2 + h^2) / d apart, where h is the height of the axis above the floor.
[[nodiscard]] double line_spacing_rad(double obstacle_m, int lines, double distance_m,
                                      double axis_height_m);

/// Plans the sweep for a speed v. The worst case: an obstacle appears just after the laser has
/// passed. The laser is back after the revisit time R (revisit_s()), in which the robot drives v R.
/// So the sweep covers the corridor from bottom to top at all distances beyond
///
///     d_min = v T_processing + v^2 / 2a + margin,
///
/// two of its lines hit the smallest obstacle at d_min, and one of them still hits it
/// 1.4 (d_min + v R) ahead. It is as short as head and line spacing allow.
class SweepPlanner {
 public:
  SweepPlanner(const robot::RobotParams& robot, const DetectionParams& detection, double fast_mps);

  /// Plans the sweep for a forward speed, metres per second, >= 0.
  [[nodiscard]] SweepPlan plan(double forward_mps) const {
    return plan(forward_mps, forward_mps, {});
  }

  /// The same, but beyond the virtual corridor the area of interest is only as wide as at a greater
  /// speed, `looking_mps`, and for what it needs to see. Where the robot uses less than 1.4 (d_min
  /// + v R), the lines are dense enough only so far, but at least to 1.2 (d_min + v R).
  [[nodiscard]] SweepPlan plan(double forward_mps, double looking_mps,
                               const NeededView& view) const;

 private:
  [[nodiscard]] SweepPlan plan_from(double appears_m, double forward_mps, double looking_mps,
                                    const NeededView& view) const;
  [[nodiscard]] double floor_from_rad(const NeededView& view) const;
  [[nodiscard]] double planned_spacing_rad(double d_min_m, double appears_m, double used_m) const;

  robot::RobotParams robot_;
  DetectionParams detection_;
  double fast_mps_;
  VirtualCorridor corridor_;
};

}  // namespace nodmap::pitch_controller
