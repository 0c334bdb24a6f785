// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/robot_params.hpp"

namespace nodmap::pitch_controller {

using robot::PitchInterval;

/// The space the robot is about to drive through (paper, II and Fig. 2), from the side, with the
/// pitch axis of the laser in it. One scan is the plane through that axis (Eq. 1), so the height at
/// which it cuts the corridor depends on the distance ahead alone, not on the width.
///
/// Distances are measured from the robot's FRONT, heights from the floor, metres.
struct VirtualCorridor {
  double bottom_m = 0.0;       ///< what is lower can be driven over
  double top_m = 0.0;          ///< what is higher can be driven under
  double axis_height_m = 0.0;  ///< of the pitch axis
  double axis_behind_front_m = 0.0;

  [[nodiscard]] static VirtualCorridor of(const robot::RobotParams& robot);

  /// Distance from the pitch axis of a place ahead of the front; never less than 5 cm.
  [[nodiscard]] double from_axis_m(double distance_m) const;

  /// The pitches that cover the corridor from bottom to top at this distance and beyond:
  ///
  ///     theta_min = -atan((axis - bottom) / z),    theta_max = atan((top - axis) / z)
  ///
  /// with z the distance from the axis.
  [[nodiscard]] PitchInterval area_from(double distance_m) const;

  /// The inverse, d_min: the distance from which on these pitches cover the corridor. Infinite
  /// where they never do.
  [[nodiscard]] double covered_from_m(const PitchInterval& area) const;
};

/// The area of interest at a speed (paper, II): all the mechanics allow at standstill, exactly
/// `corridor_area` from `fast_mps` on. In between the surplus falls with the square of the missing
/// speed: each degree outside the corridor takes sweep time that the corridor needs more.
///
/// Never wider at a greater speed, as long as `corridor_area` is not.
[[nodiscard]] PitchInterval area_of_interest(double forward_mps, double fast_mps,
                                             const PitchInterval& corridor_area,
                                             const PitchInterval& mechanics);

/// The part of the corridor in which every sweep hits even the smallest obstacle, metres ahead of
/// the front. Empty when far_m <= near_m.
struct ClearView {
  double near_m = 0.0;
  double far_m = 0.0;
};

/// The clear view of sweeps over the pitches `seen` with this angle between neighbouring scans.
/// Nearer, the pitches no longer reach bottom or top of the corridor; farther, neighbouring scans
/// lie more than `obstacle_m` apart, or `look_ahead_m` ends it.
[[nodiscard]] ClearView clear_view(const VirtualCorridor& corridor, const PitchInterval& seen,
                                   double line_spacing_rad, double obstacle_m, double look_ahead_m);

}  // namespace nodmap::pitch_controller
