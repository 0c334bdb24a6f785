// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/drawing/drawn_point.hpp"
#include "common/drawing/image.hpp"

namespace nodmap::drawing {

/// The trajectory of the robot, positions in map.
struct DrawnPath {
  std::span<const Eigen::Vector3d> corrected;  ///< one position per sweep, corrected by SLAM
  std::span<const Eigen::Vector3d> odometry;   ///< the same, by odometry alone
  std::span<const Eigen::Vector3d> keyframes;
};

/// Draws the registered cloud, coloured by height: an oblique view, and a top view below it. Leaves
/// out surfaces seen from behind, so that one can look into rooms as into a doll's house.
[[nodiscard]] Image draw_cloud(std::span<const DrawnPoint> points, const DrawnPath& path);

/// Draws the cloud from above in pale colours, and on it the corrected path and the odometry path.
[[nodiscard]] Image draw_path_on_cloud(std::span<const DrawnPoint> points, const DrawnPath& path);

}  // namespace nodmap::drawing
