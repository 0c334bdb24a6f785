// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "modules/slam6d/occupancy/cloud_voxels.hpp"
#include "modules/slam6d/occupancy/octree_grid.hpp"

namespace nodmap::slam6d {

/// The state of the walk along a beam from voxel to voxel. On each axis the beam crosses borders
/// between voxels at regular distances; the nearest of the next three borders decides which voxel
/// comes next (Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987).
struct Beam {
  std::array<double, 3> next_border_m{};      ///< from the sensor origin along the beam, for x y z
  std::array<double, 3> between_borders_m{};  ///< from one border to the next
  double length_m = 0.0;
  VoxelCode voxel = 0;  ///< the present voxel; at first that of the sensor origin
  VoxelCode end_voxel = 0;
  std::array<VoxelCode, 3> steps{};  ///< to the next voxel: 1 or -1 in the bits of the axis, or 0
  std::uint32_t num_steps = 0;  ///< to the end voxel; rounding may end the walk up to 3 earlier
};

/// Makes a beam from the sensor origin to its end, both in metres in the frame of the grid. Their
/// voxels must differ. The arithmetic equals that of OctoMap 1.9.7, computeRayKeys(), to the last
/// bit.
[[nodiscard]] Beam make_beam(const OctreeGrid& grid, const Eigen::Vector3f& p_origin,
                             const VoxelKey& origin, const Eigen::Vector3f& p_end,
                             const VoxelKey& end);

/// Marks the voxels that the beam passes through as free, including the first but not the end
/// voxel.
void walk(Beam beam, CloudVoxels& voxels);

/// The same for many beams; with AVX2, four at a time.
void walk(std::span<const Beam> beams, CloudVoxels& voxels);

}  // namespace nodmap::slam6d
