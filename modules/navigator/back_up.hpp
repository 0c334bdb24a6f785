// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "modules/navigator/corridor.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// Where the robot has just been: the only path behind it that is known to be free, for the laser
/// does not look there. It is forgotten as obstacles are: after `forget_after_m` of travel odometry
/// has drifted by more than the body keeps clear beside its strip.
class Trail {
 public:
  explicit Trail(double forget_after_m) : forget_after_m_(forget_after_m) {}

  /// The robot is here now, however it came.
  void move(const geometry::SE2& T_odom_base);

  /// Keeps a pose every 3 cm or 5 degrees, the last 5 m of them.
  void record(const geometry::SE2& T_odom_base);

  /// How to follow the trail back: first a rotation on the spot, positive left, to the heading at
  /// which the robot came, 0 when it has it; then an arc of this curvature (1/m, positive left when
  /// driven forwards).
  struct PathBack {
    double rotation_rad = 0.0;
    double curvature = 0.0;
  };
  /// Empty where the trail has ended, or jumped.
  [[nodiscard]] std::optional<PathBack> path_back(const geometry::SE2& T_odom_base) const;

  /// How far the body stays on the strip it has driven, when it drives backwards on an arc of this
  /// curvature (1/m, positive left when driven forwards); metres, at most 0.6.
  [[nodiscard]] double distance_backwards(const geometry::SE2& T_odom_base, double curvature) const;

  /// Forgets the poses ahead of a robot that backs up: its path forwards is seen by the laser.
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

  /// To be called with every pose; while backing up the trail is not extended.
  void record(const geometry::SE2& T_odom_base);

  [[nodiscard]] bool has_path(const geometry::SE2& T_odom_base) const {
    return trail_.path_back(T_odom_base).has_value();
  }

  /// The next motion: sets speed and yaw rate of `decision`. False, and it has ended, where the
  /// trail has ended, the robot cannot rotate to its heading, or it has backed up far enough.
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
