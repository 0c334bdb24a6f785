// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "modules/slam2d/matching/point_map.hpp"

namespace nodmap::slam2d {

/// How well a scan fits the map at many places at once: at those of a square lattice, all with the
/// same heading. A point scores 1 on a map point with a similar normal, less with distance, and 0
/// from `kMaxDistanceM` on.
///
/// The places are near each other, so that a point of the scan meets the same map points at many of
/// them. Each of these is found once, and compared at the few places that are in its reach. That
/// takes much less time than to search the map for each place.
class LatticeScores {
 public:
  static constexpr double kStepM = 0.25;  ///< between the places, in x and in y
  static constexpr double kMaxDistanceM = 0.25;

  /// `middle`: the middle of the lattice, in map; `steps`: how many steps it extends from there to
  /// each side.
  LatticeScores(const PointMap& map, const Eigen::Vector2d& middle, int steps);

  /// The position at (x, y) steps from the middle.
  [[nodiscard]] Eigen::Vector2d position(int x, int y) const {
    return {middle_.x() + x * kStepM, middle_.y() + y * kStepM};
  }

  /// Computes the scores of a scan, given in base, at the heading `yaw_rad`.
  void compute(std::span<const OrientedPoint> scan, double yaw_rad);

  /// The mean score of the points at (x, y) steps from the middle, as computed last; 0 without
  /// points.
  [[nodiscard]] double at(int x, int y) const { return sums_[index(x, y)] / num_points_; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>((x + steps_) * (2 * steps_ + 1) + y + steps_);
  }
  void compare(const Eigen::Vector2d& moment_arm, const Eigen::Vector2d& p_map);

  const PointMap& map_;
  Eigen::Vector2d middle_;
  int steps_;
  double num_points_ = 1.0;
  std::vector<double> sums_;  // of the scores at each place
  /// Squared distance of a point of the scan from the nearest map point at each place, or of the
  /// reach if that is less.
  std::vector<double> nearest_m2_;
};

}  // namespace nodmap::slam2d
