// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// The area of interest at a speed (R10): all the mechanics allow where the robot stands, exactly
/// `corridor_area` from `fast_mps` on. In between the share of the surroundings falls with the
/// square, for each degree around the corridor costs time that the corridor needs more.
///
/// Never wider at a greater speed, as long as `corridor_area` is not.
[[nodiscard]] PitchInterval area_of_interest(double forward_mps, double fast_mps,
                                             const PitchInterval& corridor_area,
                                             const PitchInterval& mechanics);

}  // namespace nodmap::pitch_controller
