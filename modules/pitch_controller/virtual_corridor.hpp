// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/params.hpp"

namespace nodmap::pitch_controller {

/// Pitches of the laser plane, radians; positive looks up.
struct PitchInterval {
  double min_rad = 0.0;
  double max_rad = 0.0;

  [[nodiscard]] double range_rad() const { return max_rad - min_rad; }
};

/// The space the robot is about to drive through (paper, II and Fig. 2), seen from the side, with
/// the laser's place in it. One scan is the plane through the pitch axis, so where the corridor is
/// cut depends on the way ahead alone: its width needs no mention.
///
/// Distances are ahead of the robot's FRONT, metres; heights above the floor, metres.
struct VirtualCorridor {
  double bottom_m = 0.0;       ///< what is lower can be driven over
  double top_m = 0.0;          ///< what is higher can be driven under
  double axis_height_m = 0.0;  ///< of the pitch axis
  double axis_behind_front_m = 0.0;

  [[nodiscard]] static VirtualCorridor of(const PitchControllerParams& params);

  /// From the pitch axis to a place ahead of the front; never less than 5 cm.
  [[nodiscard]] double from_axis_m(double distance_m) const;

  /// The least area of interest: the pitches that cover the corridor from bottom to top at this
  /// distance and all beyond (R9).
  [[nodiscard]] PitchInterval area_from(double distance_m) const;

  /// The other way round, d_min: the distance from which on these pitches cover the corridor.
  /// Infinite where they never do.
  [[nodiscard]] double covered_from_m(const PitchInterval& area) const;
};

}  // namespace nodmap::pitch_controller
