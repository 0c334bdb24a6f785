// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/drawing/image.hpp"
#include "modules/slam6d/registered_cloud.hpp"

namespace nodmap::slam6d {

/// Where the robot was, in map.
struct PicturePath {
  std::span<const Eigen::Vector3d> corrected;  ///< all sweeps
  std::span<const Eigen::Vector3d> odometry;   ///< the same by odometry alone
  std::span<const Eigen::Vector3d> keyframes;
};

/// The registered cloud, coloured by height: seen from obliquely above, and below that from the
/// top. Surfaces seen from behind are left out, which opens rooms like a doll's house.
[[nodiscard]] drawing::Image draw_map(std::span<const RegisteredPoint> points,
                                      const PicturePath& path);

/// The way from the top, corrected and by odometry, on the pale cloud.
[[nodiscard]] drawing::Image draw_path(std::span<const RegisteredPoint> points,
                                       const PicturePath& path);

}  // namespace nodmap::slam6d
