// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/back_end/plane_adjustment.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// A sweep that the map keeps as a whole, so that the maps can be built again from other poses.
struct Keyframe {
  std::size_t id = 0;     ///< counts the keyframes from 0; stays when others are dropped
  std::size_t sweep = 0;  ///< its number; 0 if it comes from a saved map
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  std::shared_ptr<const SweepCloud> cloud;  ///< in base; shared with the occupancy map's thread
  std::vector<OrientedPoint> points = {};   ///< its voxel means; normal zero where no plane
  std::vector<OrientedPoint> coarse_planes = {};  ///< of larger voxels, where `points` have none
  std::vector<bool> is_moved = {};  ///< of the cloud's points: on people or objects that moved
  PoseUpdate update = {};           ///< how it was found; empty if it comes from a saved map

  /// Keeps the means and planes of the cloud's voxels.
  void keep_voxels(const VoxelMap& voxels);
  /// The planes of all voxel sizes, in base, as VoxelMap::select() gives them.
  [[nodiscard]] std::vector<OrientedPoint> planes() const;

  /// Of its points.
  [[nodiscard]] std::size_t memory_bytes() const {
    return cloud->points.size() * sizeof(Eigen::Vector3f) +
           (points.size() + coarse_planes.size()) * sizeof(OrientedPoint);
  }
};

/// How far a sweep's points move when its base pose changes from `T_old` to `T_new`: the mean over
/// all distances from the base up to `max_range_m`.
[[nodiscard]] inline double motion_of_points_m(const geometry::SE3& T_old,
                                               const geometry::SE3& T_new, double max_range_m) {
  return geometry::distance_m(T_new, T_old) +
         0.5 * max_range_m * geometry::rotation_angle(T_new * T_old.inverse());
}

/// A sweep that lies between two keyframes: what the plane adjustment needs of it.
struct IntermediateSweep {
  std::size_t sweep = 0;          ///< its number
  std::vector<MeanPoint> points;  ///< in base
  PoseUpdate update = {};         ///< how it was found

  [[nodiscard]] std::size_t memory_bytes() const { return points.size() * sizeof(MeanPoint); }
};

/// The memory of keyframes, or of the sweeps in between.
template <class Kept>
[[nodiscard]] std::size_t memory_bytes(const std::vector<Kept>& kept) {
  std::size_t sum = 0;
  for (const Kept& one : kept) {
    sum += one.memory_bytes();
  }
  return sum;
}

}  // namespace nodmap::slam6d
