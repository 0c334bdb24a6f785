// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/slam6d/sweep_cloud.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// The voxels of one sweep, in base: what is registered. Where the robot moved during the sweep
/// they know when their points were measured.
[[nodiscard]] VoxelMap voxelize(const SweepCloud& cloud, const VoxelMapParams& params);

}  // namespace nodmap::slam6d
