// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "common/geometry/se2.hpp"

namespace nodmap::navigator {

/// A robot that moves backwards faster than this is reversing; odometry's noise is slower.
inline constexpr double kReversingMps = 0.02;

/// The poses where the robot has just been. The laser does not look behind the robot, so this is
/// the only path back that is known to be free. Poses are forgotten after `forget_after_m` of
/// travel, as obstacles are: odometry has then drifted by more than the clearance beside the body.
class Trail {
 public:
  explicit Trail(double forget_after_m) : forget_after_m_(forget_after_m) {}

  /// Updates the pose and the distance travelled.
  void move(const geometry::SE2& T_odom_base);

  /// Adds a pose every 3 cm or 5 degrees, and keeps those of the last 5 m.
  void record(const geometry::SE2& T_odom_base);

  /// How to follow the trail back: a rotation on the spot to the heading at which the robot came
  /// (radians, positive left; 0 if it has that heading), then an arc of this curvature (1/m,
  /// positive left when driven forwards).
  struct PathBack {
    double rotation_rad = 0.0;
    double curvature = 0.0;
  };
  /// Empty if the trail has ended or has a jump.
  [[nodiscard]] std::optional<PathBack> path_back(const geometry::SE2& T_odom_base) const;

  /// How far the robot can drive backwards on an arc before its body leaves the strip that it has
  /// driven: metres, at most 0.6. The curvature is in 1/m, positive left when driven forwards.
  [[nodiscard]] double distance_backwards(const geometry::SE2& T_odom_base, double curvature) const;

  /// Forgets poses ahead of the robot while it backs up: the laser sees the path ahead.
  void forget_ahead(const geometry::SE2& T_odom_base);

 private:
  struct Past {
    geometry::SE2 T_odom_base;
    double travel_m = 0.0;
  };

  double forget_after_m_;
  std::optional<geometry::SE2> here_;
  double travel_m_ = 0.0;
  std::deque<Past> poses_;  // oldest first
};

}  // namespace nodmap::navigator
