// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modules/navigator/local_map/local_cell.hpp"

namespace nodmap::navigator {

/// The place where the robot was set down. Elsewhere the ground that is too near for the laser has
/// been in view while the robot came. Here the laser has never looked beside the robot and behind
/// it. Frame odom.
class SetDownPlace {
 public:
  /// The laser does not see floor nearer to base than `blind_m`.
  explicit SetDownPlace(double blind_m) : blind_m_(blind_m) {}

  /// The robot was set down at `p_odom`, on floor. It is assumed where the laser does not see it
  /// whichever way the robot turns, and not farther away: a plank there was hit.
  void begin(LocalGrid& grid, const Eigen::Vector2d& p_odom);

  /// The middles of the cells within 1 m of this place that are too near to base for the laser and
  /// were never in view. Only a patch 15 cm wide and long counts: where the robot has turned, a
  /// narrower strip remains between its front and the nearest floor that the laser sees.
  [[nodiscard]] std::vector<Eigen::Vector2d> never_seen_around(
      const LocalGrid& grid, const Eigen::Vector2d& p_odom_base) const;

 private:
  double blind_m_;
  Eigen::Vector2d p_odom_ = Eigen::Vector2d::Zero();
};

}  // namespace nodmap::navigator
