// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "modules/navigator/behaviours/brake.hpp"
#include "modules/navigator/behaviours/detour.hpp"
#include "modules/navigator/behaviours/free_space.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// The free space without directions that have not been seen long enough.
[[nodiscard]] FreeSpace seen_space(const FreeSpace& space, const Situation& now);

/// Steer (paper, III C): chooses the free direction nearest to the orientation of free space, or
/// one that leads around what is between the robot and its goal. Drives an arc whose chord points
/// there, as fast as Brake allows.
class Steering {
 public:
  explicit Steering(const NavigatorParams& params);

  /// Returns the decision; empty if no direction that was seen is free.
  [[nodiscard]] std::optional<Decision> steer(const Situation& now);

  [[nodiscard]] Detour& detour() { return detour_; }

 private:
  [[nodiscard]] FreeSpace preferred_space(const Situation& now) const;
  [[nodiscard]] std::optional<double> direction(const FreeSpace& space, const Situation& now);
  [[nodiscard]] std::optional<double> roaming_direction(const FreeSpace& space, double needed_m);
  [[nodiscard]] std::optional<Arc> arc_towards(double direction_rad, const Situation& now) const;

  robot::Footprint body_;
  double side_margin_m_;
  Brake brake_;
  double stop_margin_m_;
  SteerParams params_;
  TurnParams turn_params_;
  Detour detour_;
  Side roaming_side_ = Side::kNone;  ///< on which it passes the obstacle ahead
};

}  // namespace nodmap::navigator
