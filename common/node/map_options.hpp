// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/node/node.hpp"

namespace nodmap::node {

/// The known map in which a process localises, or which it extends. Without one it builds a new
/// map.
struct MapOptions {
  std::filesystem::path localise_in;         ///< --localise; empty: none
  std::filesystem::path map_in;              ///< --map-in; empty: none
  std::optional<geometry::SE2> T_map_start;  ///< --start-pose
};

using MapNodeFactory = std::function<std::unique_ptr<Node>(Context&, const MapOptions&)>;

/// run_node() for a process that also has the options --localise, --map-in and --start-pose.
int run_map_node(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                 const MapNodeFactory& make_node);

}  // namespace nodmap::node
