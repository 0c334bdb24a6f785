// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace nodmap::navigator {

/// A person, or anything else that moves: a disc on the ground. From the tracker in odom; in a
/// Situation along the present axes of base, with the velocity over ground.
struct Person {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the disc's centre, metres
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< m/s
  double radius_m = 0.0;
  double position_sigma_m = 0.0;    ///< standard deviation, of the worse direction
  double velocity_sigma_mps = 0.0;  ///< likewise
  bool is_in_sight = true;          ///< otherwise the position is predicted, not measured
  std::int64_t track_id = 0;

  [[nodiscard]] Eigen::Vector2d position_after(double seconds) const {
    return position + seconds * velocity;
  }
};

using People = std::vector<Person>;

}  // namespace nodmap::navigator
