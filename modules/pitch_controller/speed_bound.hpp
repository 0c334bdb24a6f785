// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/stopping.hpp"
#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// Where in the corridor each sweep meets even the smallest obstacle, metres ahead of the front.
/// Empty when far_m <= near_m.
struct ClearView {
  double near_m = 0.0;
  double far_m = 0.0;
};

/// The clear view of a nod: nearer, the pitches no longer reach bottom or top of the corridor;
/// farther, its lines lie more than `obstacle_m` apart, or `look_ahead_m` ends.
[[nodiscard]] ClearView clear_view(const VirtualCorridor& corridor, const PitchInterval& seen,
                                   double line_spacing_rad, double obstacle_m, double look_ahead_m);

/// The speed up to which the robot stops in time before whatever it finds, metres per second, >= 0.
///
/// At worst an obstacle stands at the far end of the clear view just after the laser passed. It is
/// met one period, 2 T_h, later, if by then the robot has not carried its view past it; and then
/// the way has to suffice for reaction and brakes.
[[nodiscard]] double speed_bound(const ClearView& view, double sweep_s, const Stopping& stopping);

}  // namespace nodmap::pitch_controller
