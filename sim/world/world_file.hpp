// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <stdexcept>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Thrown for an invalid world; what() is one line, FILE:LINE: what.
class WorldFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a WORLD.yaml (sim/README.md) and its meshes, whose paths are relative to it. Throws
/// WorldFileError.
[[nodiscard]] World load_world(const std::filesystem::path& file);

}  // namespace nodmap::sim
