// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "sim/world/world.hpp"

namespace nodmap::evaluate {

/// All static surfaces of a world that a laser can hit: objects, floor, pits.
class WorldSurfaces {
 public:
  explicit WorldSurfaces(const sim::World& world);

  /// Distance from a point to the nearest surface, from either side, also from inside an object;
  /// metres, >= 0.
  [[nodiscard]] double distance_m(const Eigen::Vector3d& p_world) const;

  /// Calls `use` with points on all surfaces of objects, about `spacing_m` apart; without the
  /// floor, which is infinite. They are not stored: a world may have square kilometres of surfaces.
  void for_each_sample(double spacing_m,
                       const std::function<void(const Eigen::Vector3d& p_world)>& use) const;

 private:
  using Triangle = std::array<Eigen::Vector3d, 3>;

  [[nodiscard]] double floor_distance_m(const Eigen::Vector3d& p) const;

  std::vector<sim::Box> boxes_;
  std::vector<sim::Cylinder> cylinders_;
  std::vector<Triangle> triangles_;
  std::vector<sim::Pit> pits_;
};

}  // namespace nodmap::evaluate
