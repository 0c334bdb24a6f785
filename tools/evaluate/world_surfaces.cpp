// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/world_surfaces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"

namespace nodmap::evaluate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Triangle = std::array<Vector3d, 3>;
using Use = std::function<void(const Vector3d& p_world)>;

// Distance from the surface of a solid, given how far the point is outside each of its sides.
template <class Excess>
double surface_distance(const Excess& excess) {
  const double outside = excess.cwiseMax(0.0).norm();
  return outside > 0.0 ? outside : -excess.maxCoeff();
}

double distance_to(const sim::Box& box, const Vector3d& p) {
  const double c = std::cos(box.yaw_rad);
  const double s = std::sin(box.yaw_rad);
  const Vector3d d = p - box.center;
  const Vector3d p_box(c * d.x() + s * d.y(), -s * d.x() + c * d.y(), d.z());
  return surface_distance(Vector3d(p_box.cwiseAbs() - 0.5 * box.size));
}

double distance_to(const sim::Cylinder& cylinder, const Vector3d& p) {
  const Vector3d d = p - cylinder.center;
  return surface_distance(
      Vector2d(d.head<2>().norm() - cylinder.radius_m, std::abs(d.z()) - 0.5 * cylinder.height_m));
}

double distance_to_edge(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
  const Vector3d edge = b - a;
  const double length2 = edge.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
  return (p - a - share * edge).norm();
}

double distance_to(const Triangle& t, const Vector3d& p) {
  const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double area2 = normal.norm();
  bool above = area2 > 0.0;
  double nearest_edge = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d& a = t[i];
    const Vector3d& b = t[(i + 1) % 3];
    above = above && normal.dot((b - a).cross(p - a)) >= 0.0;
    nearest_edge = std::min(nearest_edge, distance_to_edge(a, b, p));
  }
  return above ? std::abs(normal.dot(p - t[0])) / area2 : nearest_edge;
}

// Two triangles with corners a, a+u, a+u+v, a+v.
void add_rectangle(const Vector3d& a, const Vector3d& u, const Vector3d& v,
                   std::vector<Triangle>& triangles) {
  triangles.push_back({a, a + u, a + u + v});
  triangles.push_back({a, a + u + v, a + v});
}

void add_ramp(const sim::Ramp& ramp, std::vector<Triangle>& triangles) {
  const Vector2d along = (ramp.to - ramp.from).head<2>().normalized();
  const Vector3d side = ramp.width_m * Vector3d(-along.y(), along.x(), 0.0);
  add_rectangle(ramp.from - 0.5 * side, ramp.to - ramp.from, side, triangles);
}

void add_pit(const sim::Pit& pit, std::vector<Triangle>& triangles) {
  const Vector3d low(pit.min.x(), pit.min.y(), -pit.depth_m);
  const Vector3d high(pit.max.x(), pit.max.y(), -pit.depth_m);
  const Vector3d x(pit.max.x() - pit.min.x(), 0.0, 0.0);
  const Vector3d y(0.0, pit.max.y() - pit.min.y(), 0.0);
  const Vector3d z(0.0, 0.0, pit.depth_m);
  add_rectangle(low, x, y, triangles);
  add_rectangle(low, x, z, triangles);
  add_rectangle(low, y, z, triangles);
  add_rectangle(high, -x, z, triangles);
  add_rectangle(high, -y, z, triangles);
}

// Calls `put(i/n, j/m)` for the centres of the cells of a grid over a patch.
template <class Put>
void over_patch(double length_m, double width_m, double spacing_m, const Put& put) {
  const int n = std::max(1, static_cast<int>(std::lround(length_m / spacing_m)));
  const int m = std::max(1, static_cast<int>(std::lround(width_m / spacing_m)));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      put((i + 0.5) / n, (j + 0.5) / m);
    }
  }
}

void sample(const sim::Box& box, double spacing_m, const Use& use) {
  const Eigen::AngleAxisd turn(box.yaw_rad, Vector3d::UnitZ());
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    over_patch(box.size[u], box.size[v], spacing_m, [&](double i, double j) {
      for (const double side : {-0.5, 0.5}) {
        Vector3d p;
        p[axis] = side * box.size[axis];
        p[u] = (i - 0.5) * box.size[u];
        p[v] = (j - 0.5) * box.size[v];
        use(box.center + turn * p);
      }
    });
  }
}

// Samples the lateral surface only, because the lids of legs and people are small.
void sample(const sim::Cylinder& cylinder, double spacing_m, const Use& use) {
  const double around_m = 2.0 * geometry::kPi * cylinder.radius_m;
  over_patch(around_m, cylinder.height_m, spacing_m, [&](double i, double j) {
    const double angle = 2.0 * geometry::kPi * i;
    use(cylinder.center + Vector3d(cylinder.radius_m * std::cos(angle),
                                   cylinder.radius_m * std::sin(angle),
                                   (j - 0.5) * cylinder.height_m));
  });
}

void sample(const Triangle& t, double spacing_m, const Use& use) {
  const Vector3d u = t[1] - t[0];
  const Vector3d v = t[2] - t[0];
  over_patch(u.norm(), v.norm(), spacing_m, [&](double i, double j) {
    if (i + j < 1.0) {
      use(t[0] + i * u + j * v);
    }
  });
}

}  // namespace

WorldSurfaces::WorldSurfaces(const sim::World& world) : pits_(world.pits) {
  for (const sim::Object& object : world.objects) {
    if (const auto* box = std::get_if<sim::Box>(&object.shape)) {
      boxes_.push_back(*box);
    } else if (const auto* cylinder = std::get_if<sim::Cylinder>(&object.shape)) {
      cylinders_.push_back(*cylinder);
    } else if (const auto* ramp = std::get_if<sim::Ramp>(&object.shape)) {
      add_ramp(*ramp, triangles_);
    } else if (const auto* mesh = std::get_if<sim::Mesh>(&object.shape)) {
      for (const Eigen::Vector3i& corners : mesh->triangles) {
        const auto vertex = [&](int i) {
          return mesh->vertices[static_cast<std::size_t>(corners[i])];
        };
        triangles_.push_back({vertex(0), vertex(1), vertex(2)});
      }
    }
  }
  for (const sim::Pit& pit : pits_) {
    add_pit(pit, triangles_);
  }
}

double WorldSurfaces::distance_m(const Vector3d& p_world) const {
  double nearest = floor_distance_m(p_world);
  for (const auto& box : boxes_) {
    nearest = std::min(nearest, distance_to(box, p_world));
  }
  for (const auto& cylinder : cylinders_) {
    nearest = std::min(nearest, distance_to(cylinder, p_world));
  }
  for (const Triangle& triangle : triangles_) {
    nearest = std::min(nearest, distance_to(triangle, p_world));
  }
  return nearest;
}

// Distance from the plane z = 0 without its holes; if pits touch, from the nearer edge.
double WorldSurfaces::floor_distance_m(const Vector3d& p) const {
  for (const sim::Pit& pit : pits_) {
    const double inside =
        std::min((p.head<2>() - pit.min).minCoeff(), (pit.max - p.head<2>()).minCoeff());
    if (inside > 0.0) {
      return std::hypot(p.z(), inside);
    }
  }
  return std::abs(p.z());
}

void WorldSurfaces::for_each_sample(double spacing_m, const Use& use) const {
  for (const auto& box : boxes_) {
    sample(box, spacing_m, use);
  }
  for (const auto& cylinder : cylinders_) {
    sample(cylinder, spacing_m, use);
  }
  for (const Triangle& triangle : triangles_) {
    sample(triangle, spacing_m, use);
  }
}

}  // namespace nodmap::evaluate
