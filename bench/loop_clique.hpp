// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "common/registration/pose_graph.hpp"

namespace nodmap::bench {

/// The largest set of loops that agree in pairs (Mangelson et al. 2018, "Pairwise consistent
/// measurement set maximization"): for each two, the way over one loop, the steps, the other loop
/// and the steps back ends where it began, within `max_chi_squared` by the covariances of both
/// loops and of the steps. Step k is from node k to node k + 1. The clique is grown greedily from
/// each loop, and the largest is returned.
[[nodiscard]] std::vector<registration::PoseEdge2d> largest_clique(
    std::span<const registration::PoseEdge2d> steps,
    std::span<const registration::PoseEdge2d> loops, double max_chi_squared);

}  // namespace nodmap::bench
