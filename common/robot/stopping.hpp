// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::robot {

// Stopping distance and its inverse, for constant speed v during the reaction time T and then
// constant deceleration a:
//
//     d(v) = v T + v^2 / (2 a),      v(d) = -a T + sqrt((a T)^2 + 2 a d).
//
// Units: metres and m/s, or radians and rad/s for a rotation.
//
// A robot that never exceeds v(d - margin) stops `margin` before an obstacle at distance d. T is
// the time from the obstacle's appearance until the wheels brake. The laser may have passed the
// obstacle just before it appeared, so T contains a full period of the nod: T = 2 T_sweep +
// T_processing. a is Braking::deceleration_mps2, half of the deceleration that the base reaches on
// command. As the robot approaches the obstacle, the bound falls at a v / (v + a T) < a, so the
// robot can always follow it.

/// The distance the robot covers until it is stationary. `speed` >= 0, `deceleration` > 0.
[[nodiscard]] double stopping_distance(double speed, double reaction_s, double deceleration);

/// The inverse: the speed from which it stops within `distance`. 0 for a distance that is zero,
/// negative or NaN; +infinity for an infinite one.
[[nodiscard]] double stoppable_speed(double distance, double reaction_s, double deceleration);

}  // namespace nodmap::robot
