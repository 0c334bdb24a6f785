// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"

namespace nodmap::slam6d {

/// How far correspondences must be searched for along normals, in metres, if odometry may be wrong
/// by `covariance` (of position and rotation). Empty if voxels of `voxel_size_m` find their
/// correspondences without such a search.
[[nodiscard]] std::optional<double> normal_reach_m(const Matrix6d& covariance,
                                                   const Matrix6d& prior_covariance,
                                                   double voxel_size_m);

/// How a point of a sweep fits a map.
enum class FitToPlane : std::uint8_t {
  kUnknown,  ///< the map has no plane near the point
  kOff,      ///< the point is off the nearest plane, or faces another way
  kOn
};

/// Finds the voxels of a map that correspond to the points of a sweep (w_ij of Eq. 3): the nearest
/// one of the same size, if its plane faces the same way. Points hardly move from step to step of a
/// registration, so the nearest voxel is looked up again only when another one may be nearest.
class CorrespondenceSearch {
 public:
  CorrespondenceSearch(const VoxelMap& map, double min_normal_cosine)
      : map_(map), min_normal_cosine_(static_cast<float>(min_normal_cosine)) {}

  /// Begins with new points, `num_points` of them.
  void begin(std::size_t num_points) { matches_.assign(num_points, {}); }

  /// From now on points without a correspondence search for one along their normals, up to this
  /// distance on both sides; 0: no longer.
  void look_along_normals(double reach_m);

  /// The voxel of `level` that corresponds to point `i`, which is now at `p_map`; null if there is
  /// none.
  [[nodiscard]] const Voxel* find(std::size_t i, std::size_t level, const Eigen::Vector3f& p_map,
                                  const Eigen::Vector3f& normal_map) {
    Match& last = matches_[i];
    if (!((p_map - last.p_map).squaredNorm() < last.sq_slack_m2)) {
      last = look_up(map_.level(level), p_map, normal_map);
    }
    return corresponds(last.place, map_.level(level), normal_map)
               ? &map_.level(level).voxels()[last.place]
               : nullptr;
  }

  /// How a point of `level` fits the map's plane there: whether it is within `max_distance_m` of it
  /// and faces the same way. The plane is one of that size or, where the map is too sparse for one,
  /// of a larger size.
  [[nodiscard]] FitToPlane fit(std::size_t level, const Eigen::Vector3f& p_map,
                               const Eigen::Vector3f& normal_map, float max_distance_m) const;

 private:
  // The nearest voxel to where a point was when it was looked up, and how far the point may move
  // from there.
  struct Match {
    Eigen::Vector3f p_map = Eigen::Vector3f::Zero();
    float sq_slack_m2 = 0.0F;
    std::uint32_t place = VoxelGrid::kNone;
  };

  [[nodiscard]] Match look_up(const VoxelGrid& grid, const Eigen::Vector3f& p_map,
                              const Eigen::Vector3f& normal_map) const;
  [[nodiscard]] bool corresponds(std::uint32_t place, const VoxelGrid& grid,
                                 const Eigen::Vector3f& normal_map) const {
    return place != VoxelGrid::kNone &&
           normal_map.dot(grid.voxels()[place].normal) >= min_normal_cosine_;
  }

  const VoxelMap& map_;
  float min_normal_cosine_;
  std::vector<Match> matches_;  // of the points
  int steps_along_normal_ = 0;  // voxels to each side
};

}  // namespace nodmap::slam6d
