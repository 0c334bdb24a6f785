// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sim/body/params.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Whether the ramp is flat enough for the robot.
[[nodiscard]] bool is_drivable(const Ramp& ramp, const BodyParams& params);

/// Height and normal of the surface under the robot.
struct Support {
  double height_m = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// The ground that the robot drives on: the floor, ramps, and box tops as platforms. Objects lower
/// than the climb height are ignored.
class Ground {
 public:
  Ground(const World& world, const BodyParams& params);

  /// The support at `p` (world) of a robot whose ground was at `height_m` one step before: the
  /// highest surface that is not a step up. Pits are no ground: the robot collides with their edge.
  [[nodiscard]] Support at(const Eigen::Vector2d& p, double height_m) const;

 private:
  std::vector<Ramp> ramps_;
  std::vector<Box> platforms_;
  double climb_height_m_;
};

}  // namespace nodmap::sim
