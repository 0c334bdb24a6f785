// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/robot_params.hpp"

namespace nodmap::pitch_controller {

using robot::PitchInterval;

/// The virtual corridor (paper, II and Fig. 2) seen from the side, with the pitch axis of the
/// laser. One scan is a plane through this axis (Eq. 1), so the height at which it crosses the
/// corridor depends on the distance ahead only, not on the width.
///
/// Distances are measured from the robot's FRONT, heights from the floor, metres.
struct VirtualCorridor {
  double bottom_m = 0.0;       ///< the robot can drive over lower obstacles
  double top_m = 0.0;          ///< the robot can drive under higher obstacles
  double axis_height_m = 0.0;  ///< height of the pitch axis
  double axis_behind_front_m = 0.0;

  [[nodiscard]] static VirtualCorridor of(const robot::RobotParams& robot);

  /// Converts a distance from the front to a distance from the pitch axis; at least 5 cm.
  [[nodiscard]] double from_axis_m(double distance_m) const;

  /// The pitches that cover the corridor from bottom to top at this distance and beyond:
  ///
  ///     theta_min = -atan((axis - bottom) / z),    theta_max = atan((top - axis) / z)
  ///
  /// with z the distance from the axis.
  [[nodiscard]] PitchInterval area_from(double distance_m) const;

  /// The inverse, d_min: the distance beyond which these pitches cover the corridor; infinite if
  /// they never do.
  [[nodiscard]] double covered_from_m(const PitchInterval& area) const;

  /// How near an obstacle of height `obstacle_m` at the bottom or top of the corridor may be to
  /// pitches that cover the corridor beyond `covered_from_m`, and still extend into them.
  [[nodiscard]] double met_from_m(double covered_from_m, double obstacle_m) const;
};

/// The area of interest for a speed (paper, II): the whole mechanical range at standstill, exactly
/// `corridor_area` from `fast_mps` on. In between the surplus shrinks with (1 - v / fast_mps)^2,
/// because each degree outside the corridor costs sweep time that the corridor needs more.
///
/// Never wider at a greater speed, provided that `corridor_area` is not.
[[nodiscard]] PitchInterval area_of_interest(double forward_mps, double fast_mps,
                                             const PitchInterval& corridor_area,
                                             const PitchInterval& mechanics);

/// The part of the corridor in which every sweep hits even the smallest obstacle, metres ahead of
/// the front. Empty if far_m <= near_m.
struct ClearView {
  double near_m = 0.0;
  double far_m = 0.0;
};

/// The head's motion: back and forth between two pitches at a constant rate.
struct NodMotion {
  PitchInterval ends;
  double rate_rad_s = 0.0;  ///< > 0
  double reversal_s = 0.0;  ///< how much longer a reversal takes than at that rate
};

/// The longest time from one measurement of an obstacle to the next, seconds, while the robot
/// drives towards it at `forward_mps`: the obstacle is anywhere in the corridor's height, and
/// `from_m` away when the laser has just passed it.
///
/// The laser is away longest from what is at the bottom while it reverses at the upper end, and
/// from what is at the top while it reverses at the lower end. What is ahead is far from both ends,
/// so this is less than two sweeps.
[[nodiscard]] double revisit_s(const VirtualCorridor& corridor, const NodMotion& nod, double from_m,
                               double forward_mps);

/// The clear view of sweeps over the pitches `seen` with `line_spacing_rad` between neighbouring
/// scans. Nearer than near_m the pitches do not reach bottom or top of the corridor. Farther than
/// far_m neighbouring scans are more than `obstacle_m` apart, or the distance exceeds
/// `look_ahead_m`.
[[nodiscard]] ClearView clear_view(const VirtualCorridor& corridor, const PitchInterval& seen,
                                   double line_spacing_rad, double obstacle_m, double look_ahead_m);

}  // namespace nodmap::pitch_controller
