// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <variant>
#include <vector>

#include "common/geometry/se2.hpp"
#include "sim/body/params.hpp"
#include "sim/body/polygon.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Where the robot's body is: an upright box on the ground.
struct BodyPose {
  geometry::SE2 T_world_base;
  double ground_m = 0.0;  ///< height of the ground at base
  double rise_m = 0.0;    ///< rise of the ground from base to a corner of the body
};

/// Detects contacts of the robot's body with obstacles (objects that reach into its height above
/// the climb height) and with the edges of pits. Obstacles are numbered: objects, then pits, in the
/// order of the world.
class Collision {
 public:
  Collision(const World& world, const BodyParams& params);

  [[nodiscard]] std::size_t size() const { return obstacles_.size(); }
  [[nodiscard]] bool is_pit(std::size_t obstacle) const {
    return obstacle >= num_objects_ && obstacle < size();
  }

  /// Horizontal distance (m) of an obstacle from the body; 0 if they touch, infinite if the body
  /// passes above or below.
  [[nodiscard]] double distance(std::size_t obstacle, const BodyPose& body) const;
  [[nodiscard]] double distance(const ActorState& actor, const BodyPose& body) const;

  /// Distance (m) of an actor's axis from the edge of the body; negative inside the body.
  [[nodiscard]] double axis_distance(const ActorState& actor, const BodyPose& body) const;

  /// The obstacles that the body touches.
  [[nodiscard]] std::vector<std::size_t> touched(const BodyPose& body) const;

  /// Distance (m) to the nearest obstacle; infinite if there is none.
  [[nodiscard]] double clearance_m(const BodyPose& body) const;

 private:
  struct Disc {
    double radius_m;
  };
  /// Collides only above `ignored_height_m` over the ground.
  struct Surface {
    std::vector<std::array<Eigen::Vector3d, 3>> triangles;
    double ignored_height_m;
  };
  struct Obstacle {
    Eigen::Vector2d center;  // centre of a circle that encloses the obstacle
    double bound_m;
    double z_min;
    double z_max;
    std::variant<Disc, Polygon, Surface> shape;
  };

  [[nodiscard]] Obstacle make_obstacle(const Object& object) const;
  [[nodiscard]] static Obstacle make_surface(const Mesh& mesh, double ignored_height_m);
  /// A lower bound of the distance that is fast to compute.
  [[nodiscard]] double distance_bound(const Obstacle& obstacle, const BodyPose& body) const;
  [[nodiscard]] double distance_to(const Obstacle& obstacle, const BodyPose& body) const;

  BodyParams params_;
  Rectangle body_;
  std::size_t num_objects_;
  std::vector<Obstacle> obstacles_;
};

}  // namespace nodmap::sim
