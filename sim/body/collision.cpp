// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/collision.hpp"

#include <algorithm>
#include <cmath>

#include "sim/body/ground.hpp"
#include "sim/world/ray_caster.hpp"

namespace nodmap::sim {
namespace {

Polygon footprint(const Box& box) {
  const geometry::SE2 T_world_box{box.center.x(), box.center.y(), box.yaw_rad};
  const double x = 0.5 * box.size.x();
  const double y = 0.5 * box.size.y();
  Polygon polygon;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(x, y), {-x, y}, Eigen::Vector2d(-x, -y), {x, -y}}) {
    polygon.add(T_world_box * corner);
  }
  return polygon;
}

Polygon footprint(const Pit& pit) {
  Polygon polygon;
  polygon.add(pit.min);
  polygon.add({pit.max.x(), pit.min.y()});
  polygon.add(pit.max);
  polygon.add({pit.min.x(), pit.max.y()});
  return polygon;
}

Polygon transformed(const geometry::SE2& T_a_b, const Polygon& polygon) {
  Polygon moved;
  const Eigen::Matrix2d R = T_a_b.rotation();
  for (const Eigen::Vector2d& p : polygon.points()) {
    moved.add(R * p + T_a_b.translation());
  }
  return moved;
}

}  // namespace

Collision::Collision(const World& world, const BodyParams& params)
    : params_(params),
      body_{{0.5 * params.length_m, 0.5 * params.width_m}},
      num_objects_(world.objects.size()) {
  for (const Object& object : world.objects) {
    obstacles_.push_back(make_obstacle(object));
  }
  for (const Pit& pit : world.pits) {
    // A body on the floor falls into the pit; one on a ramp above it does not.
    obstacles_.push_back({0.5 * (pit.min + pit.max), 0.5 * (pit.max - pit.min).norm(), -kInfinity,
                          2.0 * params.climb_height_m, footprint(pit)});
  }
}

Collision::Obstacle Collision::make_obstacle(const Object& object) const {
  if (const auto* box = std::get_if<Box>(&object.shape)) {
    return {box->center.head<2>(), 0.5 * box->size.head<2>().norm(),
            box->center.z() - 0.5 * box->size.z(), box->center.z() + 0.5 * box->size.z(),
            footprint(*box)};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) {
    return {cylinder->center.head<2>(), cylinder->radius_m,
            cylinder->center.z() - 0.5 * cylinder->height_m,
            cylinder->center.z() + 0.5 * cylinder->height_m, Disc{cylinder->radius_m}};
  }
  if (const auto* ramp = std::get_if<Ramp>(&object.shape)) {
    // The greatest rise of a drivable ramp under the body before base is on the ramp.
    const double rise_m =
        is_drivable(*ramp, params_) ? body_.half.norm() * std::tan(params_.max_slope_rad) : 0.0;
    return make_surface(to_mesh(*ramp), params_.climb_height_m + rise_m);
  }
  return make_surface(std::get<Mesh>(object.shape), params_.climb_height_m);
}

Collision::Obstacle Collision::make_surface(const Mesh& mesh, double ignored_height_m) {
  Surface surface{{}, ignored_height_m};
  Bounds bounds;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    bounds.extend({vertex, vertex});
  }
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
    surface.triangles.push_back({corner(0), corner(1), corner(2)});
  }
  const Eigen::Vector3d size = bounds.max - bounds.min;
  const Eigen::Vector3d center = 0.5 * (bounds.min + bounds.max);
  return {center.head<2>(), 0.5 * size.head<2>().norm(), bounds.min.z(), bounds.max.z(),
          std::move(surface)};
}

double Collision::distance_bound(const Obstacle& obstacle, const BodyPose& body) const {
  if (obstacle.z_max <= body.ground_m + body.rise_m + params_.climb_height_m ||
      obstacle.z_min >= body.ground_m + params_.height_m) {
    return kInfinity;
  }
  const double centers_m = (obstacle.center - body.T_world_base.translation()).norm();
  return centers_m - obstacle.bound_m - body_.half.norm();
}

double Collision::distance_to(const Obstacle& obstacle, const BodyPose& body) const {
  const geometry::SE2 T_base_world = body.T_world_base.inverse();
  if (const auto* disc = std::get_if<Disc>(&obstacle.shape)) {
    return std::max(0.0, sim::distance(body_, T_base_world * obstacle.center) - disc->radius_m);
  }
  if (const auto* polygon = std::get_if<Polygon>(&obstacle.shape)) {
    return sim::distance(body_, transformed(T_base_world, *polygon));
  }
  const auto& surface = std::get<Surface>(obstacle.shape);
  double nearest = kInfinity;
  for (const auto& triangle : surface.triangles) {
    const Polygon low = project_to_ground(triangle, body.ground_m + surface.ignored_height_m,
                                          body.ground_m + params_.height_m);
    nearest = std::min(nearest, sim::distance(body_, transformed(T_base_world, low)));
  }
  return nearest;
}

double Collision::distance(std::size_t obstacle, const BodyPose& body) const {
  return distance_bound(obstacles_[obstacle], body) < kInfinity
             ? distance_to(obstacles_[obstacle], body)
             : kInfinity;
}

double Collision::distance(const ActorState& actor, const BodyPose& body) const {
  return distance_to({actor.position, actor.radius_m, 0.0, actor.height_m, Disc{actor.radius_m}},
                     body);
}

double Collision::axis_distance(const ActorState& actor, const BodyPose& body) const {
  return signed_distance(body_, body.T_world_base.inverse() * actor.position);
}

std::vector<std::size_t> Collision::touched(const BodyPose& body) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    if (distance_bound(obstacles_[i], body) <= 0.0 && distance_to(obstacles_[i], body) <= 0.0) {
      found.push_back(i);
    }
  }
  return found;
}

double Collision::clearance_m(const BodyPose& body) const {
  double nearest = kInfinity;
  for (const Obstacle& obstacle : obstacles_) {
    if (distance_bound(obstacle, body) < nearest) {
      nearest = std::min(nearest, distance_to(obstacle, body));
    }
  }
  return nearest;
}

}  // namespace nodmap::sim
