// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Reads vertices and faces of a PLY, ASCII or binary little-endian; a face of more than three
/// corners becomes a fan of triangles. Throws std::runtime_error naming the file and what is wrong.
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& file);

}  // namespace nodmap::sim
