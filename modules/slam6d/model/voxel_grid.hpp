// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "modules/slam6d/model/voxel_index.hpp"

namespace nodmap::slam6d {

/// One cube of the grid: the mean of the points measured in it, and the plane on which it lies.
struct alignas(32) Voxel {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  float weight = 0.0F;  ///< of the mean: sum of the weights of its points
  /// Unit vector towards the side from which the plane was seen; zero where there is no plane.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float normal_weight = 0.0F;  ///< the same for the normal

  [[nodiscard]] bool has_plane() const { return !normal.isZero(0.0F); }
};

/// How the plane at a voxel is found.
struct PlaneParams {
  int min_neighbours = 6;
  double max_thickness = 0.1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer(
        "plane_min_neighbours", min_neighbours, {3, 27},
        "A voxel has a plane only if at least this many of the 27 voxels around it are occupied.");
    v.number("plane_max_thickness", max_thickness, {0.001, 1.0},
             "A voxel has a plane only if the smallest variance of these voxels is below this "
             "ratio of the middle one.");
  }
};

/// Voxel means of points in a hash table, for voxel downsampling and nearest-mean search. Voxels
/// are kept in the order in which they were first occupied, so that nothing depends on the hash.
/// Points farther than 2^20 voxels from the origin (100 km at 10 cm), or not finite, are left out.
class VoxelGrid {
 public:
  /// The index that stands for no voxel.
  static constexpr std::uint32_t kNone = VoxelIndex::kNone;

  explicit VoxelGrid(double voxel_size_m);

  /// Adds points to the means of their voxels, each with weight 1. Returns the index of each
  /// point's voxel, kNone if the point was left out.
  std::vector<std::uint32_t> add(std::span<const Eigen::Vector3f> points);

  /// Adds one mean with its weight. Returns the index of its voxel, kNone if it was left out.
  std::uint32_t add(const Eigen::Vector3f& mean, float weight);

  /// Moves each mean by `moved(place, mean)`; its voxel stays.
  template <class Moved>
  void move_means(const Moved& moved) {
    for (std::uint32_t i = 0; i < voxels_.size(); ++i) {
      voxels_[i].mean = moved(i, voxels_[i].mean);
    }
  }

  /// Finds the plane at each voxel, from the means of the 27 voxels around it. Normals point to
  /// `p_sensor`.
  void find_planes(const Eigen::Vector3f& p_sensor, const PlaneParams& params);

  /// Adds a normal to the weighted mean of the voxel's normals.
  void add_normal(std::uint32_t voxel, const Eigen::Vector3f& normal, float weight);

  /// The voxel whose mean is nearest to `p`, among the 8 voxels around it, and nearer than
  /// `max_distance_m`; kNone if there is none. A mean nearer than half a voxel is always found.
  [[nodiscard]] std::uint32_t nearest(const Eigen::Vector3f& p, float max_distance_m) const {
    return find_nearest(p, max_distance_m).place;
  }

  /// The result of nearest(), and how far `p` may move before it can change: at most a tenth of a
  /// voxel.
  struct Nearest {
    std::uint32_t place = kNone;
    float slack_m = 0.0F;
  };
  [[nodiscard]] Nearest find_nearest(const Eigen::Vector3f& p, float max_distance_m) const;

  [[nodiscard]] std::span<const Voxel> voxels() const { return voxels_; }
  [[nodiscard]] double voxel_size_m() const { return voxel_size_m_; }
  /// Points farther than this from the origin, along any axis, have no voxel, m.
  [[nodiscard]] double reach_m() const;
  /// Bytes held.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  /// The voxel at `place`, which is added if there is none.
  std::uint32_t voxel_at(const VoxelPlace& place);

  double voxel_size_m_;
  float per_m_;
  VoxelIndex index_;
  std::vector<Voxel> voxels_;  // by their numbers in index_
};

}  // namespace nodmap::slam6d
