// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "modules/navigator/corridor.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"

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

/// Backs up along the trail where the robot cannot turn, until it can.
class BackUp {
 public:
  explicit BackUp(const NavigatorParams& params);

  /// Records a pose; must be called with every pose. While the robot backs up, whoever decided
  /// that, the trail becomes shorter.
  void record(const geometry::SE2& T_odom_base, double forward_mps);

  [[nodiscard]] bool has_path(const geometry::SE2& T_odom_base) const {
    return trail_.path_back(T_odom_base).has_value();
  }

  /// Sets speed and yaw rate of `decision` for the next motion. Ends and returns false if the robot
  /// has backed up far enough, if the trail has ended, if something is right behind the robot, or
  /// if it cannot rotate to the trail's heading.
  [[nodiscard]] bool step(const Situation& now, Decision& decision);

  void end() { began_at_.reset(); }

 private:
  Footprint body_;
  robot::Braking braking_;
  double reaction_s_;
  TurnParams turn_;
  BackUpParams params_;
  Trail trail_;
  std::optional<geometry::SE2> began_at_;  // T_odom_base
};

}  // namespace nodmap::navigator
