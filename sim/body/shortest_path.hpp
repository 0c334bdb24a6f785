// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sim/body/params.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Length (m) of the shortest path on the floor from the world's start over all its goals, for a
/// disc as wide as the body: a lower bound for the robot, which cannot pass where the disc cannot.
/// Ignores actors. If the world states its own length (Task), that is returned. Empty without
/// goals, or if a goal cannot be reached.
///
/// Computed with Theta* (Nash et al., AAAI 2007) on a grid of `cell_m`, so the path is not bound to
/// the grid's directions. It is a cell or two longer than the true shortest one.
[[nodiscard]] std::optional<double> shortest_path_m(const World& world, const BodyParams& body,
                                                    double cell_m = 0.05);

}  // namespace nodmap::sim
