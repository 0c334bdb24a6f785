// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "tools/trial/trial.hpp"

namespace nodmap::trial {

/// An obstacle that appears out of nothing, straight ahead, as soon after `from_s` (from power-on)
/// as the robot drives straight at 0.5 m/s or more: at the far end of its stopping way, where it
/// must brake at once (R29). By the seed's turn it is a box on the floor of 0.10 m, the leg of a
/// chair, or a person.
///
/// Where the robot will be is found by a trial up to that moment; until something appears, the
/// same setup gives the same drive. Uses `dir`, and leaves nothing there. Throws std::runtime_error
/// when the robot never drives like that before the trial ends.
[[nodiscard]] sim::Actor place_in_the_way(const TrialSetup& setup, double from_s,
                                          const std::filesystem::path& dir);

}  // namespace nodmap::trial
