// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <variant>

#include "sim/world/world.hpp"

namespace nodmap::sim {

inline constexpr double kNoHit = std::numeric_limits<double>::infinity();

/// A ray: metres, world frame; `direction` has unit length.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
};

/// A Box with its sine and cosine.
struct RayBox {
  explicit RayBox(const Box& box);
  Eigen::Vector3d center;
  Eigen::Vector3d half;
  double cos_yaw;
  double sin_yaw;
};

struct RayCylinder {
  explicit RayCylinder(const Cylinder& cylinder);
  Eigen::Vector3d center;
  double radius;
  double half_height;
};

struct RayTriangle {
  RayTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);
  Eigen::Vector3d corner;
  Eigen::Vector3d edge_1;
  Eigen::Vector3d edge_2;
};

using RayShape = std::variant<RayBox, RayCylinder, RayTriangle>;

/// Distance along the ray to its first crossing of the surface ahead of its origin, from outside or
/// from inside; kNoHit if there is none.
[[nodiscard]] double distance_to(const RayBox& box, const Ray& ray);
[[nodiscard]] double distance_to(const RayCylinder& cylinder, const Ray& ray);
[[nodiscard]] double distance_to(const RayTriangle& triangle, const Ray& ray);

/// Unit normal at a point on the surface; it may point to either side.
[[nodiscard]] Eigen::Vector3d normal_at(const RayBox& box, const Eigen::Vector3d& p);
[[nodiscard]] Eigen::Vector3d normal_at(const RayCylinder& cylinder, const Eigen::Vector3d& p);
[[nodiscard]] Eigen::Vector3d normal_at(const RayTriangle& triangle, const Eigen::Vector3d& p);

/// An axis-aligned box.
struct Bounds {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(kNoHit);
  Eigen::Vector3d max = Eigen::Vector3d::Constant(-kNoHit);

  void extend(const Bounds& other);
};

[[nodiscard]] Bounds bounds_of(const RayBox& box);
[[nodiscard]] Bounds bounds_of(const RayCylinder& cylinder);
[[nodiscard]] Bounds bounds_of(const RayTriangle& triangle);

}  // namespace nodmap::sim
