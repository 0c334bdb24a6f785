// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "common/geometry/se2.hpp"

namespace nodmap::node {

/// The known map in which a process localises, or which it extends. Without one it builds a new
/// map.
struct MapOptions {
  std::filesystem::path localise_in;         ///< --localise; empty: none
  std::filesystem::path map_in;              ///< --map-in; empty: none
  std::optional<geometry::SE2> T_map_start;  ///< --start-pose
};

}  // namespace nodmap::node
