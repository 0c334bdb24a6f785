// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <set>
#include <variant>
#include <vector>

#include "common/geometry/se2.hpp"
#include "sim/plant_params.hpp"
#include "sim/polygon.hpp"
#include "sim/world.hpp"

namespace nodmap::sim {

/// The robot's body: a box that stands on the ground, turned about the vertical through base.
struct BodyPlace {
  geometry::SE2 T_world_base;
  double ground_m = 0.0;
  double rise_m = 0.0;  ///< of the ground under the body, from base to a corner
};

/// What the robot's body can hit: objects that reach into its height above the climb height, and
/// the edges of pits.
class Collision {
 public:
  Collision(const World& world, const PlantParams& params);

  /// Objects, then pits, in the order of the world.
  [[nodiscard]] std::size_t size() const { return things_.size(); }

  /// Horizontal distance from the body to a thing; 0 where they touch, infinite if the body passes
  /// above or below.
  [[nodiscard]] double distance(std::size_t thing, const BodyPlace& body) const;
  [[nodiscard]] double distance(const ActorState& actor, const BodyPlace& body) const;

  /// The things that the body touches.
  [[nodiscard]] std::vector<std::size_t> touched(const BodyPlace& body) const;

  /// To the nearest thing; infinite where there is none.
  [[nodiscard]] double clearance_m(const BodyPlace& body) const;

 private:
  struct Disc {
    double radius_m;
  };
  /// Counts only above `skip_m` over the ground.
  struct Surface {
    std::vector<std::array<Eigen::Vector3d, 3>> triangles;
    double skip_m;
  };
  struct Thing {
    Eigen::Vector2d center;  // of a circle that holds the thing
    double bound_m;
    double z_min;
    double z_max;
    std::variant<Disc, Polygon, Surface> shape;
  };

  [[nodiscard]] Thing make_thing(const Object& object) const;
  [[nodiscard]] static Thing make_surface(const Mesh& mesh, double skip_m);
  /// No distance to the thing is less than this.
  [[nodiscard]] double least_distance(const Thing& thing, const BodyPlace& body) const;
  [[nodiscard]] double distance_to(const Thing& thing, const BodyPlace& body) const;

  PlantParams params_;
  Rectangle body_;
  std::vector<Thing> things_;
};

/// Counts contacts: each once, until the two have come apart.
class Contacts {
 public:
  /// How far two must come apart before they can meet again.
  static constexpr double kApartM = 0.03;

  /// True if this contact is a new one.
  bool begin(std::size_t thing) { return touching_.insert(thing).second; }

  /// Forgets contacts that have come apart. `distance(thing)` tells how far away it is.
  template <class Distance>
  void end_those_apart(const Distance& distance) {
    std::erase_if(touching_, [&](std::size_t thing) { return distance(thing) > kApartM; });
  }

 private:
  std::set<std::size_t> touching_;
};

}  // namespace nodmap::sim
