// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/cloud_tracer.hpp"
#include "modules/slam6d/cloud_voxels.hpp"
#include "modules/slam6d/octree_grid.hpp"
#include "modules/slam6d/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// How points of people and of all else that moved are told from walls.
struct EverFreeParams {
  bool remove_moved = true;
  double voxel_size_m = 0.07;
  double max_range_m = 10.0;
  double through_per_hit = 4.0;
  int passing_hits = 2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("remove_moved", remove_moved,
           "Leaves out of cloud.ply and of the OctoMap what was measured in space that other "
           "sweeps saw empty: people who walked through.");
    v.number("moved_voxel_m", voxel_size_m, {0.02, 1.0},
             "Edge of the voxels in which sweeps vote whether space is empty.");
    v.number("moved_range_m", max_range_m, {0.5, 100.0},
             "Beams tell of empty space up to this length; farther away neighbouring beams are too "
             "far apart.");
    v.number("moved_through_per_hit", through_per_hit, {0.1, 100.0},
             "Space is empty where so many sweeps saw through a voxel for each one that saw "
             "something in it.");
    v.integer("moved_passing_hits", passing_hits, {0, 100},
              "So many sweeps that saw something are not counted: as many as see somebody who "
              "walks by.");
  }
};

/// Ever-free space where points were measured nevertheless: something moved there. Each sweep votes
/// for the voxels that its beams went through, and for those that they ended in. A voxel is empty
/// where many more sweeps saw through than saw something, apart from the few that see somebody who
/// walks by; space is ever-free where a voxel and all 26 beside it are empty: never so in a wall or
/// on a floor, behind which no beam ever was. What is left of somebody, beside it and beside
/// nothing that is certain, goes as well. What stands still while the robot passes cannot be
/// told from furniture. After Duberg et al., DUFOMap, 2024, which takes one look for enough.
///
/// Only sums are kept: memory grows with the space, not with time.
class EverFreeSpace {
 public:
  explicit EverFreeSpace(const EverFreeParams& params);

  /// The vote of a sweep, or of one that stands for several; `keyframe`: the last one up to it,
  /// which may be new.
  void add_sweep(const SweepCloud& cloud, const geometry::SE3& T_map_base, std::size_t keyframe,
                 int num_votes = 1);

  /// Votes move with the keyframe that saw their place last. Motions far below a voxel are left
  /// out.
  void move_keyframes(std::span<const geometry::SE3> T_map_keyframes);

  /// Which points of a keyframe's cloud moved; empty for a keyframe that did not vote, and as long
  /// as too few sweeps did.
  [[nodiscard]] std::vector<bool> moved_points(const SweepCloud& cloud, std::size_t keyframe) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  /// Of the sweeps, for one voxel.
  struct Votes {
    std::uint8_t through = 0;  ///< beams went through, and none ended in it
    std::uint8_t hits = 0;     ///< a beam ended in it

    void add(int more_through, int more_hits);
  };
  /// As in CloudVoxels: 32 x 32 x 32 voxels, in the order of their codes.
  struct Cube {
    std::array<Votes, CloudVoxels::kWords * CloudVoxels::kBitsPerWord> votes{};
    std::size_t keyframe = 0;  ///< that saw it last
  };
  using Cubes = std::map<VoxelCode, Cube>;

  [[nodiscard]] const Votes* find(VoxelCode voxel) const;
  [[nodiscard]] bool is_empty(VoxelCode voxel) const;
  /// Whether somebody who walked by may be all that was seen there.
  [[nodiscard]] bool is_passing(VoxelCode voxel) const;
  [[nodiscard]] bool is_ever_free(const VoxelKey& key) const;
  void add_rest(std::span<const std::optional<VoxelKey>> keys, std::vector<bool>& is_moved) const;
  void move(const Cube& cube, VoxelCode code, const geometry::SE3& T_new_old, Cubes& moved) const;

  EverFreeParams params_;
  CloudTracer tracer_;
  int num_votes_ = 0;     // so far, up to as many as are needed
  CloudVoxels of_sweep_;  // kept for its memory
  Cubes cubes_;
  std::vector<geometry::SE3> T_map_keyframes_;  // as they voted
};

}  // namespace nodmap::slam6d
