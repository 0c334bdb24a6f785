// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
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

/// The distance from a place to the line along which a person walks, from where they are after
/// `from_s` on, for `duration_s`; backwards if that is negative.
[[nodiscard]] inline double distance_to_path(const Eigen::Vector2d& p, const Person& person,
                                             double from_s, double duration_s) {
  const Eigen::Vector2d along = duration_s * person.velocity;
  const Eigen::Vector2d offset = p - person.position_after(from_s);
  const double share =
      std::clamp(offset.dot(along) / std::max(along.squaredNorm(), 1e-9), 0.0, 1.0);
  return (offset - share * along).norm();
}

}  // namespace nodmap::navigator
