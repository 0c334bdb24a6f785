// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// What Turn needs to know of a moment.
struct TurnView {
  std::int64_t utime_us = 0;
  double heading_rad = 0.0;  ///< of base in odom
  double yaw_rate_rad_s = 0.0;
  /// Nearest direction with enough free way in view, positive left; empty: none.
  std::optional<double> free_direction_rad;
  double more_room_side = 0.0;  ///< +1, -1: where there is more room; 0: the same on both
  bool ahead_is_free = false;   ///< as far as points tell
  bool ahead_was_seen = false;  ///< and it was looked at long enough to trust that
  /// To each side: how far it may turn, and how far it is to the first direction that looks free;
  /// +infinity where there is no end, or none.
  struct Side {
    double free_turn_rad = 0.0;
    double until_free_rad = 0.0;
  };
  Side left;
  Side right;
  bool knows_way_back = false;  ///< that it came
};

/// What Turn wants.
struct TurnCommand {
  enum class Kind : std::uint8_t {
    kTurn,     ///< on the spot, at yaw_rate_rad_s
    kLook,     ///< stands until the laser has seen what is ahead
    kBackUp,   ///< can turn neither way far enough
    kWait,     ///< a whole turn found nothing: stands, and tries again later
    kFinished  ///< ahead is free: Steer goes on
  };
  Kind kind = Kind::kTurn;
  double yaw_rate_rad_s = 0.0;
};

/// Turn: turns into a free direction when Brake is active (paper, III C). The side is chosen once
/// and kept until the way ahead is free: to the free direction in view, else to where there is more
/// room. It changes only when something does not let the robot turn on, once. Where that is to be
/// seen from the beginning, on both sides, it first goes back the way it came. A dead end is left
/// within one turn; after a whole one without a free direction the robot stands, and tries again:
/// what moves may have moved away.
class Turn {
 public:
  explicit Turn(const NavigatorParams& params) : params_(params) {}

  /// `preferred_side`: +1 or -1 to prefer a side (that of a detour), 0 for none.
  TurnCommand step(const TurnView& view, double preferred_side);

  /// Gives up for now, as after a whole turn.
  void pause(std::int64_t utime_us);

  [[nodiscard]] bool is_active() const { return active_; }
  [[nodiscard]] bool backs_up() const { return backs_up_; }
  [[nodiscard]] double side() const { return side_; }
  void end() { active_ = false; }

 private:
  void begin(const TurnView& view, double preferred_side);
  void consider_room(const TurnView& view);
  [[nodiscard]] TurnCommand turn_on(const TurnView& view);

  NavigatorParams params_;
  bool active_ = false;
  double side_ = 1.0;
  bool reversed_ = false;
  bool backs_up_ = false;
  double last_heading_rad_ = 0.0;
  double turned_rad_ = 0.0;
  double least_turn_rad_ = 0.0;  ///< before ahead counts as free
  std::optional<std::int64_t> waits_since_us_;
};

/// The rate of a turn on the spot that ends within `way_rad`.
[[nodiscard]] double turn_rate(double way_rad, const NavigatorParams& params);

}  // namespace nodmap::navigator
