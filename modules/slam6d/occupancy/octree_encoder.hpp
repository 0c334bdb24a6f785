// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "modules/slam6d/occupancy/log_odds_map.hpp"

namespace nodmap::slam6d {

/// The octree that OctoMap makes of a map, as the bytes of its files: eight equal leaves are merged
/// into one, and an inner node has the highest value of its children. No tree is built: the nodes
/// are written in one pass over the map. Source: OctoMap 1.9.7, OcTreeBaseImpl::writeNodesRecurs(),
/// OccupancyOcTreeBase::writeBinaryNode().

/// A .bt file: occupied or free.
[[nodiscard]] std::string encode_bt(const LogOddsMap& map, double resolution_m);

/// A .ot file: log-odds.
[[nodiscard]] std::string encode_ot(const LogOddsMap& map, double resolution_m);

/// Number of inner nodes and leaves of the octree.
[[nodiscard]] std::size_t count_nodes(const LogOddsMap& map);

}  // namespace nodmap::slam6d
