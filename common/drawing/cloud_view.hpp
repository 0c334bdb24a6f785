// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/drawing/drawn_point.hpp"
#include "common/drawing/image.hpp"

namespace nodmap::drawing {

/// Where the robot was, in map.
struct DrawnPath {
  std::span<const Eigen::Vector3d> corrected;  ///< all sweeps
  std::span<const Eigen::Vector3d> odometry;   ///< the same by odometry alone
  std::span<const Eigen::Vector3d> keyframes;
};

/// The registered cloud, coloured by height: seen from obliquely above, and below that from the
/// top. Surfaces seen from behind are left out, which opens rooms like a doll's house.
[[nodiscard]] Image draw_cloud(std::span<const DrawnPoint> points, const DrawnPath& path);

/// The path from above, corrected and by odometry, on the pale cloud.
[[nodiscard]] Image draw_path_on_cloud(std::span<const DrawnPoint> points, const DrawnPath& path);

}  // namespace nodmap::drawing
