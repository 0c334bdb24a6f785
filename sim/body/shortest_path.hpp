// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sim/body/params.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Length (m) of the shortest path from the world's start over all its goals, on the floor, for a
/// disc as wide as the body. A robot with this body cannot have a shorter one, because it cannot
/// pass where the disc cannot. Ignores actors. Returns the world's own value (Task) if it has one;
/// empty without goals, or if a goal cannot be reached.
///
/// Theta* (Nash et al., AAAI 2007) on a grid of `cell_m`: an any-angle path, longer than the
/// shortest one by a cell or two.
[[nodiscard]] std::optional<double> shortest_path_m(const World& world, const BodyParams& body,
                                                    double cell_m = 0.05);

}  // namespace nodmap::sim
