// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::robot {

// Reaction at constant speed, then even braking:
//
//     d(v) = v T + v^2 / (2 a),      v(d) = -a T + sqrt((a T)^2 + 2 a d).
//
// Units: metres and m/s, or radians and rad/s for a rotation.
//
// Why a robot that never exceeds v(d - margin) stops `margin` before an obstacle at distance d:
// T covers everything between the obstacle's appearance and the first braking wheel. Where the
// laser may have passed just before, that is a full period of the nod: T = 2 T_sweep +
// T_processing. a is the deceleration the base is trusted with (Braking::deceleration_mps2), half
// of what it does on command. Driving on, the bound falls at a v / (v + a T) < a: the robot can
// always follow it.

/// The distance the robot covers until it is stationary. `speed` >= 0, `deceleration` > 0.
[[nodiscard]] double stopping_distance(double speed, double reaction_s, double deceleration);

/// The inverse: the speed from which it stops within `distance`. 0 for a distance that is zero,
/// negative or NaN; +infinity for an infinite one.
[[nodiscard]] double stoppable_speed(double distance, double reaction_s, double deceleration);

}  // namespace nodmap::robot
