// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// The sweeps of a drive from its first on, with which the map can begin again once it is known how
/// the laser is mounted. Kept until the robot has moved during more than 30 of them. While it is
/// stationary for long most are kept without beams: their poses alone matter.
class FirstSweeps {
 public:
  /// Adds the next sweep; drops all if they are too many.
  void add(const PlacedSweep& sweep);
  /// Drops all, and keeps no others: the map cannot begin again.
  void drop();

  [[nodiscard]] bool are_kept() const { return are_kept_; }
  [[nodiscard]] std::span<const PlacedSweep> sweeps() const { return sweeps_; }
  /// How many of them have no beams.
  [[nodiscard]] std::size_t num_emptied() const { return num_emptied_; }

 private:
  bool are_kept_ = true;
  std::vector<PlacedSweep> sweeps_;
  std::size_t num_emptied_ = 0;
  geometry::SE3 T_odom_place_ = geometry::SE3::Identity();  // where the robot stopped last
  std::size_t num_at_place_ = 0;
};

}  // namespace nodmap::slam6d
