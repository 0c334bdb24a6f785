// SPDX-License-Identifier: BSD-3-Clause
// How well registered scans agree. This shares no code with 6D SLAM, which it measures: no voxel
// map, no search structure, no kernel.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"

namespace nodmap::bench {

/// The means of a scan's points (metres, in the frame of the scanner) in voxels of 10 cm. Only
/// points with ranges between 0.48 m and 30 m count: nearer ones are the robot, farther ones are
/// too sparse.
[[nodiscard]] std::vector<Eigen::Vector3d> voxel_means(std::span<const Eigen::Vector3d> points);

/// The distances of a scan's points from the planes of another.
struct PlaneResidual {
  std::size_t num_points = 0;  ///< that have a plane of the other scan near them
  double share = 0.0;          ///< of all points; a small one makes small distances easy
  double median_m = 0.0;
  double p90_m = 0.0;
};

/// Measures how far the points of `scan` are from the planes of `model`, at the relative pose of
/// the two. Both are voxel means. A point of the model has a plane if its 16 nearest points, itself
/// included, lie within 60 cm, and the smallest of their three principal variances is less than 2 %
/// of the middle one. A point of the scan counts if its nearest point in the model is within 50 cm
/// and has a plane.
[[nodiscard]] PlaneResidual plane_residual(std::span<const Eigen::Vector3d> model,
                                           std::span<const Eigen::Vector3d> scan,
                                           const geometry::SE3& T_model_scan);

}  // namespace nodmap::bench
