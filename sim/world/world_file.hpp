// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <stdexcept>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// A world that cannot be used; what() is one line, FILE:LINE: what.
class WorldFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a WORLD.yaml (sim/README.md) with the meshes it names, which are looked for beside it.
/// Throws WorldFileError.
[[nodiscard]] World load_world(const std::filesystem::path& file);

}  // namespace nodmap::sim
