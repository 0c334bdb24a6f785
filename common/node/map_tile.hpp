// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/map_tile.hpp"
#include "nodmap/grid_chunk_t.hpp"

namespace nodmap::node {

/// Reads a tile of MAP_2D, whose cells stay those of the message. Empty if its numbers are not
/// plausible: they are not finite, contradict each other, or are so large that indices of cells
/// would not be exact.
[[nodiscard]] std::optional<geometry::MapTile> read_map_tile(const nodmap::grid_chunk_t& message);

}  // namespace nodmap::node
