// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "tools/trial/params.hpp"

namespace nodmap::trial {

/// The robots that a trial can be driven with. KURT3D is the default of all parameters; Jackal is
/// the robot of the BARN challenge: 0.508 m x 0.430 m, differential drive, 2 m/s, and a laser of
/// 270 degrees and 720 beams that is held level.
enum class Robot : std::uint8_t { kKurt3d, kJackal };

/// Sets the parameters of simulator and software to the robot's values.
void set_robot(Robot robot, AllParams& params);

}  // namespace nodmap::trial
