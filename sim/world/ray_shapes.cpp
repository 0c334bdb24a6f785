// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/ray_shapes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace {

// The distances for which a ray is between two parallel planes.
struct Interval {
  double enter = -kNoHit;
  double leave = kNoHit;

  void cut(const Interval& other) {
    enter = std::max(enter, other.enter);
    leave = std::min(leave, other.leave);
  }
  [[nodiscard]] double first_crossing() const {
    if (enter > leave || leave <= 0.0) {
      return kNoHit;
    }
    return enter > 0.0 ? enter : leave;
  }
};

Interval slab(double origin, double direction, double half) {
  if (direction == 0.0) {
    return std::abs(origin) <= half ? Interval{} : Interval{kNoHit, -kNoHit};
  }
  const double inverse = 1.0 / direction;
  const double a = (-half - origin) * inverse;
  const double b = (half - origin) * inverse;
  return {std::min(a, b), std::max(a, b)};
}

// Coordinates in the frame of the box, from coordinates relative to its centre.
Eigen::Vector3d to_box(const RayBox& box, const Eigen::Vector3d& v) {
  return {box.cos_yaw * v.x() + box.sin_yaw * v.y(), -box.sin_yaw * v.x() + box.cos_yaw * v.y(),
          v.z()};
}

}  // namespace

RayBox::RayBox(const Box& box)
    : center(box.center),
      half(0.5 * box.size),
      cos_yaw(std::cos(box.yaw_rad)),
      sin_yaw(std::sin(box.yaw_rad)) {}

RayCylinder::RayCylinder(const Cylinder& cylinder)
    : center(cylinder.center), radius(cylinder.radius_m), half_height(0.5 * cylinder.height_m) {}

RayTriangle::RayTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& c)
    : corner(a), edge_1(b - a), edge_2(c - a) {}

double distance_to(const RayBox& box, const Ray& ray) {
  const Eigen::Vector3d o = to_box(box, ray.origin - box.center);
  const Eigen::Vector3d d = to_box(box, ray.direction);
  Interval inside = slab(o.x(), d.x(), box.half.x());
  inside.cut(slab(o.y(), d.y(), box.half.y()));
  inside.cut(slab(o.z(), d.z(), box.half.z()));
  return inside.first_crossing();
}

double distance_to(const RayCylinder& cylinder, const Ray& ray) {
  const Eigen::Vector3d o = ray.origin - cylinder.center;
  const Eigen::Vector3d& d = ray.direction;
  Interval inside = slab(o.z(), d.z(), cylinder.half_height);
  const double a = d.head<2>().squaredNorm();
  const double b = o.head<2>().dot(d.head<2>());
  const double c = o.head<2>().squaredNorm() - cylinder.radius * cylinder.radius;
  if (a == 0.0) {
    return c <= 0.0 ? inside.first_crossing() : kNoHit;
  }
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) {
    return kNoHit;
  }
  const double root = std::sqrt(discriminant);
  inside.cut({(-b - root) / a, (-b + root) / a});
  return inside.first_crossing();
}

// Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997.
double distance_to(const RayTriangle& triangle, const Ray& ray) {
  const Eigen::Vector3d p = ray.direction.cross(triangle.edge_2);
  const double determinant = triangle.edge_1.dot(p);
  if (determinant == 0.0) {
    return kNoHit;
  }
  const Eigen::Vector3d s = ray.origin - triangle.corner;
  const double u = s.dot(p) / determinant;
  const Eigen::Vector3d q = s.cross(triangle.edge_1);
  const double v = ray.direction.dot(q) / determinant;
  const double t = triangle.edge_2.dot(q) / determinant;
  if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0) {
    return t;
  }
  return kNoHit;
}

Eigen::Vector3d normal_at(const RayBox& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d local = to_box(box, p - box.center);
  Eigen::Index axis = 0;
  (local.cwiseAbs() - box.half).maxCoeff(&axis);  // 0 on the face, negative off it
  Eigen::Vector3d n = Eigen::Vector3d::Unit(axis);
  return {box.cos_yaw * n.x() - box.sin_yaw * n.y(), box.sin_yaw * n.x() + box.cos_yaw * n.y(),
          n.z()};
}

Eigen::Vector3d normal_at(const RayCylinder& cylinder, const Eigen::Vector3d& p) {
  const Eigen::Vector3d local = p - cylinder.center;
  const double beyond_side = local.head<2>().norm() - cylinder.radius;
  const double beyond_cap = std::abs(local.z()) - cylinder.half_height;
  if (beyond_cap > beyond_side) {
    return Eigen::Vector3d::UnitZ();
  }
  return Eigen::Vector3d(local.x(), local.y(), 0.0).normalized();
}

Eigen::Vector3d normal_at(const RayTriangle& triangle, const Eigen::Vector3d& /*p*/) {
  return triangle.edge_1.cross(triangle.edge_2).normalized();
}

void Bounds::extend(const Bounds& other) {
  min = min.cwiseMin(other.min);
  max = max.cwiseMax(other.max);
}

Bounds bounds_of(const RayBox& box) {
  const double c = std::abs(box.cos_yaw);
  const double s = std::abs(box.sin_yaw);
  const Eigen::Vector3d half(c * box.half.x() + s * box.half.y(),
                             s * box.half.x() + c * box.half.y(), box.half.z());
  return {box.center - half, box.center + half};
}

Bounds bounds_of(const RayCylinder& cylinder) {
  const Eigen::Vector3d half(cylinder.radius, cylinder.radius, cylinder.half_height);
  return {cylinder.center - half, cylinder.center + half};
}

Bounds bounds_of(const RayTriangle& triangle) {
  const Eigen::Vector3d b = triangle.corner + triangle.edge_1;
  const Eigen::Vector3d c = triangle.corner + triangle.edge_2;
  return {triangle.corner.cwiseMin(b).cwiseMin(c), triangle.corner.cwiseMax(b).cwiseMax(c)};
}

}  // namespace nodmap::sim
