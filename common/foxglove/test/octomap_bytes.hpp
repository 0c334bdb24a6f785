// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

namespace nodmap::foxglove::test {

/// The bytes of an OctoMap file with these voxels occupied (places counted from the origin, each
/// once), nothing pruned and nothing free.
[[nodiscard]] std::string octomap_bytes(double voxel_m,
                                        const std::vector<std::array<int, 3>>& voxels);

}  // namespace nodmap::foxglove::test
