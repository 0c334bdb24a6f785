// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace {

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length_sq = along.squaredNorm();
  const double fraction =
      length_sq > 0.0 ? std::clamp((p - a).dot(along) / length_sq, 0.0, 1.0) : 0.0;
  return (p - a - fraction * along).norm();
}

// Whether projections onto `normal` do not overlap.
bool separates(const Eigen::Vector2d& normal, const Rectangle& rectangle, const Polygon& polygon) {
  const double reach = normal.cwiseAbs().dot(rectangle.half);
  double least = kInfinity;
  double most = -kInfinity;
  for (const Eigen::Vector2d& p : polygon.points()) {
    least = std::min(least, normal.dot(p));
    most = std::max(most, normal.dot(p));
  }
  return least > reach || most < -reach;
}

// Separating axis theorem.
bool overlap(const Rectangle& rectangle, const Polygon& polygon) {
  if (separates(Eigen::Vector2d::UnitX(), rectangle, polygon) ||
      separates(Eigen::Vector2d::UnitY(), rectangle, polygon)) {
    return false;
  }
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Eigen::Vector2d edge = polygon.corners[(i + 1) % polygon.size] - polygon.corners[i];
    if (separates({-edge.y(), edge.x()}, rectangle, polygon)) {
      return false;
    }
  }
  return true;
}

// One step of Sutherland and Hodgman: keeps the part above a height (side +1) or below it (-1).
template <class Points>
std::size_t cut(Points& corners, std::size_t size, double z, double side) {
  Points kept;
  std::size_t count = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const Eigen::Vector3d& a = corners[i];
    const Eigen::Vector3d& b = corners[(i + 1) % size];
    const double above_a = side * (a.z() - z);
    const double above_b = side * (b.z() - z);
    if (above_a >= 0.0) {
      kept[count++] = a;
    }
    if ((above_a > 0.0 && above_b < 0.0) || (above_a < 0.0 && above_b > 0.0)) {
      kept[count++] = a + above_a / (above_a - above_b) * (b - a);
    }
  }
  corners = kept;
  return count;
}

}  // namespace

double distance(const Rectangle& rectangle, const Eigen::Vector2d& p) {
  return (p.cwiseAbs() - rectangle.half).cwiseMax(0.0).norm();
}

double signed_distance(const Rectangle& rectangle, const Eigen::Vector2d& p) {
  const Eigen::Vector2d outside = p.cwiseAbs() - rectangle.half;
  return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0);
}

double distance(const Rectangle& rectangle, const Polygon& polygon) {
  if (polygon.size == 0) {
    return kInfinity;
  }
  if (overlap(rectangle, polygon)) {
    return 0.0;
  }
  // The shortest connection begins or ends at a corner.
  double nearest = kInfinity;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Eigen::Vector2d& a = polygon.corners[i];
    const Eigen::Vector2d& b = polygon.corners[(i + 1) % polygon.size];
    nearest = std::min(nearest, distance(rectangle, a));
    for (const double x : {-rectangle.half.x(), rectangle.half.x()}) {
      for (const double y : {-rectangle.half.y(), rectangle.half.y()}) {
        nearest = std::min(nearest, distance_to_segment({x, y}, a, b));
      }
    }
  }
  return nearest;
}

Polygon project_to_ground(const std::array<Eigen::Vector3d, 3>& triangle, double z_min,
                          double z_max) {
  std::array<Eigen::Vector3d, 8> corners;
  std::ranges::copy(triangle, corners.begin());
  std::size_t size = cut(corners, 3, z_min, 1.0);
  size = cut(corners, size, z_max, -1.0);
  Polygon polygon;
  for (std::size_t i = 0; i < size; ++i) {
    polygon.add(corners[i].head<2>());
  }
  return polygon;
}

}  // namespace nodmap::sim
