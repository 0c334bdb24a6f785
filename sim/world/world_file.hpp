// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// The largest number that files of worlds may contain: metres, degrees or seconds. Any larger one
/// is a mistake, and would only fail at the end of a simulation.
constexpr double kMaxWorldNumber = 1e5;

/// Reads a WORLD.yaml (sim/README.md) and its meshes, whose paths are relative to it. Throws
/// formats::InputFileError for an invalid world, with one line: FILE:LINE: what.
[[nodiscard]] World load_world(const std::filesystem::path& file);

}  // namespace nodmap::sim
