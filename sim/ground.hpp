// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sim/plant_params.hpp"
#include "sim/world.hpp"

namespace nodmap::sim {

/// Whether the robot can drive up this ramp.
[[nodiscard]] bool is_drivable(const Ramp& ramp, const PlantParams& params);

/// What carries the robot at one point.
struct Support {
  double height_m = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// The ground that the robot drives on: the floor, ramps, and boxes as platforms. Things lower than
/// the climb height leave no trace.
class Ground {
 public:
  Ground(const World& world, const PlantParams& params);

  /// What carries a robot whose ground was at `height_m` a moment ago: the highest surface that is
  /// no step up. Below the floor nothing is looked for: pits are not driven in, but fallen into.
  [[nodiscard]] Support at(const Eigen::Vector2d& p, double height_m) const;

 private:
  std::vector<Ramp> ramps_;
  std::vector<Box> platforms_;
  double climb_height_m_;
};

}  // namespace nodmap::sim
