// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

namespace nodmap::sim {

/// The distance of an empty polygon.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A convex polygon in the plane with few corners, in order; also a segment or a point.
struct Polygon {
  // A triangle cut by two planes has five corners at most.
  std::array<Eigen::Vector2d, 8> corners;
  std::size_t size = 0;

  void add(const Eigen::Vector2d& p) { corners[size++] = p; }
  [[nodiscard]] std::span<const Eigen::Vector2d> points() const { return {corners.data(), size}; }
};

/// A rectangle about the origin, along the axes; `half` is half its length and width.
struct Rectangle {
  Eigen::Vector2d half;
};

/// Distance of a point from the rectangle; 0 inside.
[[nodiscard]] double distance(const Rectangle& rectangle, const Eigen::Vector2d& p);

/// Distance of a point from the edge of the rectangle; negative inside.
[[nodiscard]] double signed_distance(const Rectangle& rectangle, const Eigen::Vector2d& p);

/// Distance of a polygon from the rectangle; 0 if they overlap or touch, infinite for an empty
/// polygon.
[[nodiscard]] double distance(const Rectangle& rectangle, const Polygon& polygon);

/// Vertical projection of the part of a triangle between two heights.
[[nodiscard]] Polygon project_to_ground(const std::array<Eigen::Vector3d, 3>& triangle,
                                        double z_min, double z_max);

}  // namespace nodmap::sim
