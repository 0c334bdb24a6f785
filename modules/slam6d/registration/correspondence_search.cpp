// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/correspondence_search.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace nodmap::slam6d {
namespace {

// Farthest correspondence, in voxels: half of one is always found, 1.5 is the most that can be.
constexpr double kMaxCorrespondenceVoxels = 1.5;
// Search distance along a normal: as far as the prior may be wrong.
constexpr double kNormalReachSigmas = 2.0;
constexpr double kMaxReachVoxels = 6.0;

float max_correspondence_m(const VoxelGrid& grid) {
  return static_cast<float>(kMaxCorrespondenceVoxels * grid.voxel_size_m());
}

}  // namespace

std::optional<double> normal_reach_m(const Matrix6d& covariance, const Matrix6d& prior_covariance,
                                     double voxel_size_m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance.topLeftCorner<3, 3>(),
                                                             Eigen::EigenvaluesOnly);
  const double nearest_m = kMaxCorrespondenceVoxels * voxel_size_m;
  if (!(eigen.eigenvalues()[2] > nearest_m * nearest_m)) {
    return std::nullopt;
  }
  return std::min(kNormalReachSigmas * std::sqrt(prior_covariance.diagonal().head<3>().maxCoeff()),
                  kMaxReachVoxels * voxel_size_m);
}

void CorrespondenceSearch::look_along_normals(double reach_m) {
  steps_along_normal_ = static_cast<int>(std::ceil(reach_m / map_.level(0).voxel_size_m()));
}

CorrespondenceSearch::Match CorrespondenceSearch::look_up(const VoxelGrid& grid,
                                                          const Eigen::Vector3f& p_map,
                                                          const Eigen::Vector3f& normal_map) const {
  const auto voxel_size_m = static_cast<float>(grid.voxel_size_m());
  const float max_m = max_correspondence_m(grid);
  VoxelGrid::Nearest nearest = grid.find_nearest(p_map, max_m);
  for (int k = 1; k <= 2 * steps_along_normal_ && !corresponds(nearest.place, grid, normal_map);
       ++k) {
    // 1, -1, 2, -2, ...
    const auto step = static_cast<float>(k % 2 == 1 ? (k + 1) / 2 : -k / 2);
    nearest = grid.find_nearest(p_map + step * voxel_size_m * normal_map, max_m);
  }
  return {p_map, nearest.slack_m * nearest.slack_m, nearest.place};
}

FitToPlane CorrespondenceSearch::fit(std::size_t level, const Eigen::Vector3f& p_map,
                                     const Eigen::Vector3f& normal_map,
                                     float max_distance_m) const {
  for (; level < VoxelMap::kLevels; ++level) {
    const VoxelGrid& grid = map_.level(level);
    const std::uint32_t place = grid.nearest(p_map, max_correspondence_m(grid));
    if (place != VoxelGrid::kNone && grid.voxels()[place].has_plane()) {
      const Voxel& voxel = grid.voxels()[place];
      const bool is_on = corresponds(place, grid, normal_map) &&
                         std::abs(voxel.normal.dot(voxel.mean - p_map)) < max_distance_m;
      return is_on ? FitToPlane::kOn : FitToPlane::kOff;
    }
  }
  return FitToPlane::kUnknown;
}

}  // namespace nodmap::slam6d
