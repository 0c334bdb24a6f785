// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tools/trial/trial.hpp"

namespace nodmap::trial {

/// The content of result.json without the values that depend on the wall clock. Reads the
/// trajectories that SLAM has written into `dir`.
[[nodiscard]] nlohmann::ordered_json summarise(const TrialSetup& setup, const TrialOutcome& outcome,
                                               const std::filesystem::path& dir);

/// Writes path.png. Throws std::runtime_error.
void write_path_image(const TrialSetup& setup, const TrialOutcome& outcome,
                      const std::filesystem::path& dir);

}  // namespace nodmap::trial
