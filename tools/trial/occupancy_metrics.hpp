// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <set>

#include "common/formats/octomap_file.hpp"
#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam6d/occupancy/cloud_tracer.hpp"
#include "sim/world/world.hpp"

namespace nodmap::trial {

/// The voxels of the map frame that the laser has hit, computed with the robot's true poses. An
/// OctoMap of 6D SLAM should contain them as occupied.
class ObservedVoxels {
 public:
  using Voxel = std::array<std::int32_t, 3>;

  /// `params`: of the OctoMap: edge of a voxel, and the range up to which beams are inserted.
  explicit ObservedVoxels(const slam6d::TraceParams& params = {}) : params_(params) {}

  /// Edge of a voxel, m.
  [[nodiscard]] double voxel_m() const { return params_.resolution_m; }
  [[nodiscard]] Voxel voxel_at(const Eigen::Vector3d& p_map) const;

  /// Adds the end points of a scan. `T_map_first`, `T_map_last`: true poses of base at its first
  /// and last beam.
  void add(const scan::Scan& scan, const geometry::SE3& T_map_first,
           const geometry::SE3& T_map_last);

  [[nodiscard]] const std::set<Voxel>& voxels() const { return voxels_; }

 private:
  slam6d::TraceParams params_;
  std::set<Voxel> voxels_;
};

/// An occupancy map compared with the true world; both with a tolerance of one voxel.
struct OccupancyMetrics {
  std::size_t num_occupied = 0;
  std::size_t num_observed = 0;
  double precision = 0.0;  ///< fraction of the occupied voxels that are at a true surface
  double recall = 0.0;     ///< fraction of the observed voxels that are occupied
};

/// All zero for an empty map. `map` must have voxels of the observed size. `T_world_map`: the
/// robot's start.
[[nodiscard]] OccupancyMetrics occupancy_metrics(const formats::OccupiedSpace& map,
                                                 const ObservedVoxels& observed,
                                                 const geometry::SE3& T_world_map,
                                                 const sim::World& world);

}  // namespace nodmap::trial
