// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "modules/navigator/behaviours/brake.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/situation.hpp"
#include "modules/navigator/trail.hpp"
#include "modules/navigator/twist.hpp"

namespace nodmap::navigator {

/// Backs up along the trail where the robot cannot turn, until it can. It has a trail of its own,
/// without what lies ahead of a robot that has backed up: the next time the path back begins here.
class BackUp {
 public:
  explicit BackUp(const NavigatorParams& params);

  /// Records a pose; must be called with every pose. While the robot backs up, whoever decided
  /// that, the trail becomes shorter.
  void record(const geometry::SE2& T_odom_base, double forward_mps);

  [[nodiscard]] bool has_path(const geometry::SE2& T_odom_base) const {
    return trail_.path_back(T_odom_base).has_value();
  }

  /// The next motion, from which the robot stops as `brake` says. Ends, and returns nothing, if the
  /// robot has backed up far enough, if the trail has ended, if something is right behind the
  /// robot, or if it cannot rotate to the trail's heading.
  [[nodiscard]] std::optional<Twist> step(const Situation& now, const Brake& brake);

  void end() { began_at_.reset(); }

 private:
  robot::Footprint body_;
  double turn_margin_m_;
  BackUpParams params_;
  Trail trail_;
  std::optional<geometry::SE2> began_at_;  // T_odom_base
};

}  // namespace nodmap::navigator
