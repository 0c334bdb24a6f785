// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "modules/slam6d/cloud_tracer.hpp"
#include "modules/slam6d/keyframe.hpp"
#include "modules/slam6d/octree_grid.hpp"

namespace nodmap::slam6d {

/// How points of people and of all else that moved are told from walls.
struct EverFreeParams {
  bool remove_moved = true;
  double voxel_size_m = 0.1;
  double max_range_m = 10.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("remove_moved", remove_moved,
           "Leaves out of cloud.ply what was measured in space that other keyframes saw empty: "
           "people who walked through.");
    v.number("moved_voxel_m", voxel_size_m, {0.02, 1.0},
             "Edge of the voxels in which keyframes vote whether space is empty.");
    v.number("moved_range_m", max_range_m, {0.5, 100.0},
             "Beams tell of empty space up to this length; farther away neighbouring beams are too "
             "far apart.");
  }
};

/// Ever-free space where points were measured nevertheless: something moved there. Each keyframe
/// votes for the voxels that its beams went through, or ended in or beside. Space is ever-free
/// where at least as many keyframes saw through a voxel as saw something there, and where beams
/// went through all 26 voxels beside it, too: never so in a wall or on a floor, behind which no
/// beam ever was. What stands still while the robot passes cannot be told from furniture.
class EverFreeSpace {
 public:
  EverFreeSpace(const EverFreeParams& params, std::span<const Keyframe> keyframes);

  /// Whether a point of one of the keyframes, at its place in map, has moved there.
  [[nodiscard]] bool contains(const Eigen::Vector3f& p_map) const;

 private:
  OctreeGrid grid_;
  std::vector<VoxelCode> moved_;  // voxels in which points ended, in order
};

}  // namespace nodmap::slam6d
