// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/world/world.hpp"

namespace nodmap::evaluate {

/// Everything in a world that a laser can meet and that stays where it is: objects, floor, pits.
class WorldSurfaces {
 public:
  explicit WorldSurfaces(const sim::World& world);

  /// From a point to the nearest surface, from whatever side; metres, >= 0. Points inside an object
  /// have a distance, too.
  [[nodiscard]] double distance_m(const Eigen::Vector3d& p_world) const;

  /// Points on all surfaces of objects, evenly about `spacing_m` apart; the floor is left out, for
  /// it has no end.
  [[nodiscard]] std::vector<Eigen::Vector3d> samples(double spacing_m) const;

 private:
  using Triangle = std::array<Eigen::Vector3d, 3>;

  [[nodiscard]] double floor_distance_m(const Eigen::Vector3d& p) const;

  std::vector<sim::Box> boxes_;
  std::vector<sim::Cylinder> cylinders_;
  std::vector<Triangle> triangles_;
  std::vector<sim::Pit> pits_;
};

}  // namespace nodmap::evaluate
