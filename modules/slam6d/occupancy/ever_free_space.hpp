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
#include "modules/slam6d/model/replaced_keyframe.hpp"
#include "modules/slam6d/occupancy/cloud_tracer.hpp"
#include "modules/slam6d/occupancy/cloud_voxels.hpp"
#include "modules/slam6d/occupancy/octree_grid.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// How points on people, and on everything else that moved, are distinguished from walls.
struct EverFreeParams {
  bool remove_moved = true;
  double voxel_size_m = 0.07;
  double max_range_m = 10.0;
  double through_per_hit = 4.0;
  int passing_hits = 2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("remove_moved", remove_moved,
           "Leave points out of cloud.ply and the OctoMap if they were measured where other sweeps "
           "saw "
           "empty space, as on people who walked through.");
    v.number("moved_voxel_m", voxel_size_m, {0.02, 1.0},
             "Edge of the voxels for which sweeps vote whether they are empty.");
    v.number(
        "moved_range_m", max_range_m, {0.5, 100.0},
        "Beams vote for empty space up to this length; farther away neighbouring beams are too "
        "far apart.");
    v.number("moved_through_per_hit", through_per_hit, {0.1, 100.0},
             "A voxel is empty if at least this many sweeps saw through it for each one that saw "
             "something in it.");
    v.integer(
        "moved_passing_hits", passing_hits, {0, 100},
        "This many of the sweeps that saw something are not counted: as many as see somebody who "
        "walks by.");
  }
};

/// Finds ever-free space, and the points that were measured in it: something moved there. Each
/// sweep votes for the voxels that its beams passed through and for those in which they ended. A
/// voxel is empty if many more sweeps saw through it than saw something in it; the few that may
/// have seen somebody walk by are not counted. A voxel is ever-free if it and all 26 voxels beside
/// it are empty. A wall or a floor never is, because no beam ever passed behind it. Points beside
/// those that moved are removed as well, because they are the rest of the same person, unless
/// something certain is beside them. Whoever stands still while the robot passes cannot be
/// distinguished from furniture. After Duberg et al., DUFOMap, 2024, where one sighting is enough.
///
/// Only sums of votes are kept, so memory grows with the space, not with time. The first sweeps
/// wait until there are enough votes to decide anything, and are counted then.
class EverFreeSpace {
 public:
  explicit EverFreeSpace(const EverFreeParams& params);

  /// Adds the votes of a sweep. `num_votes`: the number of sweeps that it represents. `keyframe`:
  /// the sweep itself if it is a keyframe, otherwise the last keyframe before it.
  void add_sweep(const SweepCloud& cloud, const geometry::SE3& T_map_base, std::size_t keyframe,
                 int num_votes = 1);

  /// Moves votes with the keyframe that saw their place last. Motions far below the size of a voxel
  /// are ignored.
  void move_keyframes(std::span<const geometry::SE3> T_map_keyframes);

  /// Gives the votes of a dropped keyframe to the one that replaces it, and renumbers the others.
  void drop_keyframe(const ReplacedKeyframe& replaced);

  /// For each point of a keyframe's cloud, whether it lies on something that moved. Empty if the
  /// keyframe has not voted, or if too few sweeps have.
  [[nodiscard]] std::vector<bool> moved_points(const SweepCloud& cloud, std::size_t keyframe) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  /// The votes of all sweeps for one voxel.
  struct Votes {
    std::uint8_t through = 0;  ///< sweeps whose beams passed through, none ending in it
    std::uint8_t hits = 0;     ///< sweeps of which a beam ended in it

    void add(int more_through, int more_hits);
  };
  /// 32 x 32 x 32 voxels in the order of their codes, as in CloudVoxels.
  struct Cube {
    std::array<Votes, CloudVoxels::kWords * CloudVoxels::kBitsPerWord> votes{};
    std::size_t keyframe = 0;  ///< the keyframe that saw the cube last

    void add(const CloudVoxels::Cube& of_sweep, int num_votes);
  };
  using Cubes = std::map<VoxelCode, Cube>;
  /// A sweep that votes.
  struct Voter {
    SweepCloud cloud;
    geometry::SE3 T_voxels_base;
    std::size_t keyframe = 0;
    int num_votes = 1;
  };

  /// A point's voxel, empty outside of the grid, and the votes for it, null if there are none.
  struct PlacedPoint {
    std::optional<VoxelKey> key;
    const Votes* votes = nullptr;
  };

  /// Finds the votes for a voxel; null if there are none. It keeps the cube of the last voxel,
  /// which is mostly that of the next one, too.
  class Lookup {
   public:
    explicit Lookup(const Cubes& cubes) : cubes_(cubes) {}
    [[nodiscard]] const Votes* find(VoxelCode voxel);

   private:
    const Cubes& cubes_;
    VoxelCode code_ = ~VoxelCode{0};  // of the last cube: none
    const Cube* cube_ = nullptr;
  };

  void count_votes(const SweepCloud& cloud, const geometry::SE3& T_voxels_base,
                   std::size_t keyframe, int num_votes);
  [[nodiscard]] bool is_empty(const Votes* votes) const;
  /// Whether everything that was seen there may be somebody who walked by.
  [[nodiscard]] bool is_passing(const Votes* votes) const;
  /// Whether a wall or furniture is there.
  [[nodiscard]] bool is_certain(const Votes* votes) const;
  [[nodiscard]] bool is_ever_free(const PlacedPoint& point, Lookup& lookup) const;
  /// Whether a point there may be what is left of somebody: nothing is certain there or beside it.
  [[nodiscard]] bool is_uncertain(const PlacedPoint& point, Lookup& lookup) const;
  /// Adds the points that are left of somebody.
  void add_rest(std::span<const PlacedPoint> points, std::vector<bool>& is_moved) const;
  void move(const Cube& cube, VoxelCode code, const geometry::SE3& T_new_old, Cubes& moved) const;

  EverFreeParams params_;
  CloudTracer tracer_;
  int num_votes_ = 0;           // so far; not counted beyond what is needed
  std::vector<Voter> waiting_;  // whose votes are not counted yet
  CloudVoxels of_sweep_;        // of the last sweep; kept to reuse its memory
  Cubes cubes_;
  std::vector<geometry::SE3> T_voxels_keyframes_;  // the poses at which the votes are
};

}  // namespace nodmap::slam6d
