// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/replaced_keyframe.hpp"
#include "modules/slam6d/model/voxel_grid.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// How voxels and planes are made from a point cloud, and how sweeps are joined in the map.
struct VoxelMapParams {
  double voxel_size_m = 0.1;
  PlaneParams plane{};
  double trusted_range_m = 30.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("voxel_size_m", voxel_size_m, {0.01, 1.0},
             "Edge of the finest voxels, within which points are averaged; the coarser ones are "
             "twice and four times as large.");
    plane.describe(v);
    v.number("trusted_range_m", trusted_range_m, {0.1, 100.0},
             "A point at this range has half the weight of a near one, because errors of direction "
             "grow with the range.");
  }
};

/// A point of a plane, as registration uses it.
struct OrientedPoint {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float num_points = 0.0F;  ///< measured points of which `p` is the mean
  float time = 0.0F;        ///< at which they were measured, from -1 to 1 over the sweep
};

/// Whether a plane with this z component of its unit normal is upright, a wall.
[[nodiscard]] inline bool is_upright(float normal_up) {
  return std::abs(normal_up) < 0.5F;
}

/// The means of all voxels; normal zero where there is no plane.
[[nodiscard]] std::vector<OrientedPoint> oriented_points(const VoxelGrid& grid);

/// At most `max` of these, spread over all.
template <class Point>
[[nodiscard]] std::vector<Point> some_of(const std::vector<Point>& all, std::size_t max) {
  const std::size_t stride = (all.size() + max - 1) / max;
  std::vector<Point> some;
  for (std::size_t i = 0; i < all.size(); i += stride) {
    some.push_back(all[i]);
  }
  return some;
}

/// When the points of a cloud were measured.
struct PointTimes {
  std::vector<float> times;  ///< of each point, from -1 to 1; empty if all are from one pose
  Eigen::Vector3f half_path = Eigen::Vector3f::Zero();  ///< of the base, from time 0 to 1
};

/// A point cloud as voxel means of three sizes, with their planes. A scanner sees near surfaces
/// densely and far ones sparsely: where fine voxels are too sparse for a plane, coarser ones have
/// one.
class VoxelMap {
 public:
  static constexpr std::size_t kLevels = 3;  ///< level 0 is the finest

  explicit VoxelMap(const VoxelMapParams& params);

  /// The voxels of one cloud, seen from `p_sensor`. All in one frame, metres.
  static VoxelMap from_points(std::span<const Eigen::Vector3f> points,
                              const Eigen::Vector3f& p_sensor, const VoxelMapParams& params,
                              const PointTimes& times = {});

  /// Whether the scanner moved while it measured this cloud.
  [[nodiscard]] bool is_moving() const { return !times_[0].empty(); }
  [[nodiscard]] const Eigen::Vector3f& half_path() const { return half_path_; }

  /// Fixes the motion within the cloud, which is no longer corrected.
  void hold();

  /// Deskews the cloud again and recomputes its planes.
  void correct(const MotionCorrection& correction);

  /// Adds the voxels of a sweep to this map, as part of a keyframe. Means and normals are weighted
  /// by inverse variance, which decreases with range, so that near sightings correct far ones.
  void add_sweep(const VoxelMap& sweep_base, const geometry::SE3& T_map_base,
                 std::size_t keyframe = 0);

  /// Adds those voxels of another map whose keyframe is chosen, each moved with its keyframe by
  /// `T_new_old`. `T_new_old` and `is_chosen` have one entry per keyframe. A voxel belongs to the
  /// keyframe that saw it last.
  void add_keyframes(const VoxelMap& map, std::span<const geometry::SE3> T_new_old,
                     const std::vector<bool>& is_chosen);

  /// Gives the voxels of a dropped keyframe to the one that replaces it, and renumbers the others.
  void drop_keyframe(const ReplacedKeyframe& replaced);

  [[nodiscard]] const VoxelGrid& level(std::size_t l) const { return levels_[l]; }

  /// The points that are registered at level `l`: its planes, and those of coarser levels where the
  /// finer ones have none. `first_of_level`: where the points of each level begin.
  struct Selection {
    std::vector<OrientedPoint> points;
    std::array<std::size_t, kLevels + 1> first_of_level{};
  };
  [[nodiscard]] Selection select(std::size_t l) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  void assign(std::size_t level, std::uint32_t place, std::size_t keyframe);
  /// Adds the planes of the voxels that are not covered by a finer plane, and marks these voxels as
  /// covered.
  void add_planes(std::size_t level, std::vector<char>& is_covered,
                  std::vector<OrientedPoint>& points) const;
  /// The voxels of level `level` + 1 that have a covered voxel within.
  [[nodiscard]] std::vector<char> cover_coarser(std::size_t level,
                                                const std::vector<char>& is_covered) const;

  VoxelMapParams params_;
  std::array<VoxelGrid, kLevels> levels_;
  /// The keyframe of each voxel; only used in a map.
  std::array<std::vector<std::uint32_t>, kLevels> keyframes_;
  Eigen::Vector3f p_sensor_ = Eigen::Vector3f::Zero();
  /// For each voxel of level l, the index of its voxel at level l + 1; only used in a single cloud.
  std::array<std::vector<std::uint32_t>, kLevels - 1> coarser_;
  /// Mean time of each voxel's points; only used in a cloud measured while the robot moved.
  std::array<std::vector<float>, kLevels> times_;
  Eigen::Vector3f half_path_ = Eigen::Vector3f::Zero();
};

/// The voxels of one sweep, in base, for registration. If the robot moved during the sweep, they
/// have the times at which their points were measured.
[[nodiscard]] VoxelMap voxelize(const SweepCloud& cloud, const VoxelMapParams& params);

}  // namespace nodmap::slam6d
