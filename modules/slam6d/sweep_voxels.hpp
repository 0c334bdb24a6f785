// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/slam6d/sweep_cloud.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// The voxels of one sweep, in base, for registration. If the robot moved during the sweep, they
/// have the times at which their points were measured.
[[nodiscard]] VoxelMap voxelize(const SweepCloud& cloud, const VoxelMapParams& params);

}  // namespace nodmap::slam6d
