// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>

#include "common/formats/octomap_file.hpp"
#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"
#include "sim/world/world.hpp"

namespace nodmap::trial {

/// The voxels of the map frame that the laser has hit, computed with the robot's true poses. A map
/// should contain them as occupied.
class ObservedVoxels {
 public:
  /// The defaults of 6D SLAM's OctoMap: edge of a voxel, and the range up to which beams are
  /// inserted.
  static constexpr double kVoxelM = 0.05;
  static constexpr double kMaxRangeM = 10.0;

  using Voxel = std::array<std::int32_t, 3>;
  [[nodiscard]] static Voxel voxel_at(const Eigen::Vector3d& p_map);

  /// Adds the end points of a scan. `T_map_first`, `T_map_last`: true poses of base at its first
  /// and last beam.
  void add(const scan::Scan& scan, const geometry::SE3& T_map_first,
           const geometry::SE3& T_map_last);

  [[nodiscard]] const std::set<Voxel>& voxels() const { return voxels_; }

 private:
  std::set<Voxel> voxels_;
};

/// An occupancy map compared with the true world; both with a tolerance of one voxel.
struct OccupancyMetrics {
  std::size_t num_occupied = 0;
  std::size_t num_observed = 0;
  double precision = 0.0;  ///< fraction of the occupied voxels that are at a true surface
  double recall = 0.0;     ///< fraction of the observed voxels that are occupied
};

/// All zero for an empty map, or one with another voxel size. `T_world_map`: the robot's start.
[[nodiscard]] OccupancyMetrics occupancy_metrics(const formats::OccupiedSpace& map,
                                                 const ObservedVoxels& observed,
                                                 const geometry::SE3& T_world_map,
                                                 const sim::World& world);

}  // namespace nodmap::trial
