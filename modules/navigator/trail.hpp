// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "common/geometry/se2.hpp"

namespace nodmap::navigator {

/// Where the robot has just been: the one way behind it that is known to be free, for the laser
/// does not look there.
class Trail {
 public:
  /// Poses are kept every 3 cm or 5 degrees, the last 5 m of them.
  void record(const geometry::SE2& T_odom_base);

  /// How to go back along the trail: first a turn on the spot by `turn_rad`, positive left, to the
  /// heading at which the robot came, 0 when it has it; then an arc of this curvature (1/m,
  /// positive left when driven forwards).
  struct WayBack {
    double turn_rad = 0.0;
    double curvature = 0.0;
  };
  /// Empty where the trail has ended, or jumped.
  [[nodiscard]] std::optional<WayBack> way_back(const geometry::SE2& T_odom_base) const;

  /// Forgets what lies ahead of a robot that goes back: its way out again is seen by the laser.
  void retreat(const geometry::SE2& T_odom_base);

  void forget() { poses_.clear(); }

 private:
  std::deque<geometry::SE2> poses_;  // T_odom_base, oldest first
};

}  // namespace nodmap::navigator
