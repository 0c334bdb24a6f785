// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "sim/body/params.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Whether the ramp is flat enough for the robot.
[[nodiscard]] bool is_drivable(const Ramp& ramp, const BodyParams& params);

/// Height and normal of the plane on which the robot's wheels stand.
struct Support {
  double height_m = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// The ground under a wheel.
struct WheelContact {
  double height_m = 0.0;
  /// Index in World::objects of the ramp whose side or end is too high a step, if any.
  std::optional<std::size_t> blocking_object;
};

/// The ground that wheels roll on: the floor, ramps, and box tops as platforms. Objects lower than
/// the climb height are ignored. Pits do not count as ground; the body collides with their edges.
class Ground {
 public:
  Ground(const World& world, const BodyParams& params);

  /// Whether there is only the floor.
  [[nodiscard]] bool is_flat() const { return ramps_.empty(); }

  /// The ground at `p` (world) for a wheel that was at `height_m` one step before: the highest
  /// surface that is not a step up.
  [[nodiscard]] WheelContact roll(const Eigen::Vector2d& p, double height_m) const;

 private:
  struct Slope {
    Ramp ramp;
    std::size_t object;
  };
  std::vector<Slope> ramps_;
  std::vector<Box> platforms_;
  double climb_height_m_;
  double body_height_m_;
};

}  // namespace nodmap::sim
