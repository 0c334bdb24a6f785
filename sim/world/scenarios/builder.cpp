// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/scenarios/builder.hpp"

#include <cmath>
#include <utility>

namespace nodmap::sim {
namespace {

constexpr double kWallHeightM = 2.5;
constexpr double kWallThicknessM = 0.1;

Eigen::Vector2d flipped(const Eigen::Vector2d& p) {
  return {p.x(), -p.y()};
}

Eigen::Vector3d flipped(const Eigen::Vector3d& p) {
  return {p.x(), -p.y(), p.z()};
}

void flip(Box& box) {
  box.center = flipped(box.center);
  box.yaw_rad = -box.yaw_rad;
}

void flip(Cylinder& cylinder) {
  cylinder.center = flipped(cylinder.center);
}

void flip(Ramp& ramp) {
  ramp.from = flipped(ramp.from);
  ramp.to = flipped(ramp.to);
}

void flip(Mesh& mesh) {
  for (Eigen::Vector3d& vertex : mesh.vertices) {
    vertex = flipped(vertex);
  }
}

}  // namespace

void Builder::wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double thickness_m,
                   double reflectivity) {
  const Eigen::Vector2d along = to - from;
  const Eigen::Vector2d middle = 0.5 * (from + to);
  // Extends below the floor, for walls beside a pit.
  box(middle, {along.norm(), thickness_m}, {-1.0, kWallHeightM}, std::atan2(along.y(), along.x()),
      reflectivity);
}

void Builder::wall_with_door(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                             double middle_m, double width_m) {
  const Eigen::Vector2d along = (to - from).normalized();
  wall(from, from + (middle_m - 0.5 * width_m) * along);
  wall(from + (middle_m + 0.5 * width_m) * along, to);
}

void Builder::walls_around(const Eigen::Vector2d& min, const Eigen::Vector2d& max) {
  const double half_m = 0.5 * kWallThicknessM;
  const Eigen::Vector2d a = min.array() - half_m;
  const Eigen::Vector2d b = max.array() + half_m;
  wall({a.x() - half_m, a.y()}, {b.x() + half_m, a.y()});
  wall({a.x() - half_m, b.y()}, {b.x() + half_m, b.y()});
  wall({a.x(), a.y()}, {a.x(), b.y()});
  wall({b.x(), a.y()}, {b.x(), b.y()});
}

void Builder::box(const Eigen::Vector2d& center, const Eigen::Vector2d& size,
                  const Heights& heights, double yaw_rad, double reflectivity) {
  const double height_m = heights.top_m - heights.bottom_m;
  world_.objects.push_back({Box{{center.x(), center.y(), heights.bottom_m + 0.5 * height_m},
                                {size.x(), size.y(), height_m},
                                yaw_rad},
                            reflectivity});
}

void Builder::cylinder(const Eigen::Vector2d& center, double radius_m, double height_m) {
  world_.objects.push_back(
      {Cylinder{{center.x(), center.y(), 0.5 * height_m}, radius_m, height_m}});
}

void Builder::pit(const Eigen::Vector2d& min, const Eigen::Vector2d& max, double depth_m) {
  world_.pits.push_back({min, max, depth_m});
}

void Builder::ramp(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width_m) {
  world_.objects.push_back({Ramp{from, to, width_m}});
}

World Builder::finish() {
  return count(0, 1) == 0 ? world_ : mirrored(world_);
}

World mirrored(World world) {
  for (Object& object : world.objects) {
    std::visit([](auto& shape) { flip(shape); }, object.shape);
  }
  for (Pit& pit : world.pits) {
    pit.min = flipped(pit.min);
    pit.max = flipped(pit.max);
    std::swap(pit.min.y(), pit.max.y());
  }
  for (Actor& actor : world.actors) {
    for (Waypoint& waypoint : actor.path) {
      waypoint.position = flipped(waypoint.position);
    }
  }
  for (Eigen::Vector2d& goal : world.goals) {
    goal = flipped(goal);
  }
  world.T_world_start.y = -world.T_world_start.y;
  world.T_world_start.yaw = -world.T_world_start.yaw;
  return world;
}

}  // namespace nodmap::sim
