// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/registration/pose_graph.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// All that is needed to continue a map, or to localise in it: its keyframes, and how they are
/// joined. Voxels and OctoMap are made from their clouds.
struct SavedMap {
  struct Keyframe {
    std::shared_ptr<const SweepCloud> cloud;  ///< in base; at least its time, points and lines
    geometry::SE3 T_map_base = geometry::SE3::Identity();
    bool is_level = false;  ///< wheels on level ground
  };

  std::vector<Keyframe> keyframes;
  /// The edge to each keyframe but the first, from an earlier one: step k - 1 leads to keyframe k.
  std::vector<registration::PoseEdge3d> steps;
  std::vector<registration::PoseEdge3d> loops;
};

}  // namespace nodmap::slam6d
