// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/drawing/drawn_point.hpp"

namespace nodmap::drawing {

/// A point in an image. Of two points in the same place, the one with the smaller depth (m) is
/// visible.
struct Pixel {
  double x = 0.0;
  double y = 0.0;
  double depth = 0.0;
};

/// Projects points in map into an image.
struct Camera {
  Eigen::Vector3d p_map_camera = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_camera_map = Eigen::Matrix3d::Identity();  ///< rows: right, down, ahead
  double focal_px = 1.0;  ///< perspective; orthographic: pixels per metre
  bool is_perspective = true;
  double centre_x = 0.0;
  double centre_y = 0.0;

  /// Projects a point; empty if it is behind the camera.
  [[nodiscard]] std::optional<Pixel> project(const Eigen::Vector3d& p_map) const;

  [[nodiscard]] double pixels_per_m(double depth) const {
    return is_perspective ? focal_px / depth : focal_px;
  }

  /// Whether the camera sees the front of the point's surface; true for points without a normal.
  [[nodiscard]] bool faces(const DrawnPoint& point) const;
};

struct ImageSize {
  int width = 0;
  int height = 0;
};

/// A camera that looks obliquely down at the building, zoomed so that nearly all points fill the
/// image.
[[nodiscard]] Camera oblique_camera(std::span<const DrawnPoint> points, const ImageSize& size);

/// A camera that looks straight down, with the building's long axis to the right.
[[nodiscard]] Camera top_camera(std::span<const DrawnPoint> points, const ImageSize& size);

}  // namespace nodmap::drawing
