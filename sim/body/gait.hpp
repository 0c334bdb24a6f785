// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// The legs of a person who walks. They swing along the walking direction, one against the other,
/// by the distance walked.
class Gait {
 public:
  explicit Gait(const Eigen::Vector2d& position) : position_(position) {}

  /// Moves the person, who looks where they walk.
  void move_to(const Eigen::Vector2d& position);
  [[nodiscard]] Legs legs() const;

 private:
  Eigen::Vector2d position_;
  Eigen::Vector2d heading_ = Eigen::Vector2d::UnitX();
  double walked_m_ = 0.0;
};

}  // namespace nodmap::sim
