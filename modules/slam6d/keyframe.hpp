// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/pose_covariance.hpp"
#include "modules/slam6d/sweep_cloud.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// Why the map keeps a sweep.
enum class KeyframeReason { kFirst, kInterruption, kDistance, kRotation };

/// A sweep that the map keeps as a whole, so that the maps can be built again from other poses.
struct Keyframe {
  std::size_t id = 0;     ///< counts the keyframes from 0; stays when others are dropped
  std::size_t sweep = 0;  ///< index of its update; 0 if it comes from a saved map
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  std::shared_ptr<const SweepCloud> cloud;  ///< in base; shared with the occupancy map's thread
  std::vector<OrientedPoint> points;  ///< the voxel means of the cloud; normal zero where no plane
  std::vector<bool> is_moved = {};    ///< of the cloud's points: on people or objects that moved
};

/// A sweep that lies between two keyframes: what the plane adjustment needs of it.
struct IntermediateSweep {
  std::size_t sweep = 0;              ///< index of its update
  std::vector<OrientedPoint> points;  ///< as those of a keyframe
};

}  // namespace nodmap::slam6d
