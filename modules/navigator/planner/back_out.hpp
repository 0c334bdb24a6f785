// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/behaviours/brake.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/patience.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// Backs out of the dead end or corner in which the robot was set down, facing into it, where it
/// can neither drive on nor turn round: until it can, as far as its range finders see free space
/// behind it, and no farther than RearView permits. On the arc with the most room, and so slowly
/// that it always stops before what is measured.
class BackOut {
 public:
  explicit BackOut(const NavigatorParams& params);

  /// The next motion; empty while it need not back out, or cannot.
  [[nodiscard]] std::optional<Decision> step(const Situation& now);

  /// Whether it has backed out, and is still near the place where it was set down. There what the
  /// range finders have measured counts as obstacles.
  [[nodiscard]] bool is_leaving(const Situation& now) const;

 private:
  [[nodiscard]] bool can_turn_round(const Points& points_base) const;
  [[nodiscard]] bool counts_as_stuck(const Situation& now);
  [[nodiscard]] double curvature_with_most_room(const Points& points_base) const;

  robot::Footprint body_;
  Brake brake_;
  double speed_mps_;
  bool is_active_ = false;
  bool has_begun_ = false;
  std::optional<geometry::SE2> T_odom_stuck_;  // where the robot has been all the time
  Patience without_progress_;
};

/// The situation with what the range finders have measured beside and behind the robot.
[[nodiscard]] Situation with_rear_view(Situation now);

}  // namespace nodmap::navigator
