// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "tools/trial/trial.hpp"

namespace nodmap::trial {

/// Adds an obstacle that appears straight ahead, at the far end of the stopping zone, where the
/// robot must brake at once. It appears when the robot first drives straight at 0.5 m/s or more
/// after `from_s` (seconds from power-on). The seed selects a box on the floor of 0.10 m, the leg
/// of a chair, or a person.
///
/// A trial without it determines where the robot will be, because the same setup gives the same
/// drive until the obstacle appears. It goes on for another 3 s, longer than any answer may take,
/// and becomes `setup.undisturbed`. Uses `dir`, and leaves nothing there. Throws std::runtime_error
/// if the robot never drives like that before the trial ends.
void add_appearing_obstacle(TrialSetup& setup, double from_s, const std::filesystem::path& dir);

}  // namespace nodmap::trial
