// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"
#include "modules/navigator/behaviours/side.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// The inputs of Turn.
struct TurnInput {
  time::Timestamp stamp{};
  double heading_rad = 0.0;  ///< of base in odom
  double yaw_rate_rad_s = 0.0;
  /// The nearest free direction in view, positive left; empty if there is none, or if there is one
  /// equally near on each side.
  std::optional<double> clear_direction_rad;
  Side more_room_side = Side::kNone;  ///< see side_with_more_room()
  bool ahead_is_free = false;         ///< no point of the map ahead
  bool ahead_is_seen = false;         ///< that direction was in view long enough
  /// On one side: how far the body can rotate (+infinity: nothing ends the rotation), and how far
  /// it is to the first direction without points (+infinity: there is none).
  struct Room {
    double free_rotation_rad = 0.0;
    double to_clear_direction_rad = 0.0;
  };
  Room left;
  Room right;
  bool has_path_back = false;  ///< whether it could back up along its trail

  [[nodiscard]] const Room& on(Side side) const { return side == Side::kLeft ? left : right; }
};

/// What Turn asks for.
struct TurnCommand {
  enum class Kind : std::uint8_t {
    kTurn,     ///< rotate on the spot, at yaw_rate_rad_s
    kLook,     ///< wait until the laser has seen what is ahead
    kBackUp,   ///< back up: it cannot rotate far enough to either side
    kWait,     ///< a full rotation found nothing: wait, and try again later
    kFinished  ///< ahead is free: Steer takes over
  };
  Kind kind = Kind::kTurn;
  double yaw_rate_rad_s = 0.0;
};

/// Turn (paper, III C): rotates to a free direction when Brake is active.
///
/// The side is chosen once and kept until ahead is free: the side of the nearest free direction in
/// view, or else the one with more room. It changes at most once, if an obstacle ends the rotation.
/// If obstacles end the rotation on both sides from the beginning, the robot first backs up. So it
/// leaves a dead end within one full rotation. After a full rotation without a free direction it
/// waits and tries again, because obstacles may have moved.
class Turn {
 public:
  explicit Turn(const NavigatorParams& params)
      : params_(params.turn), base_params_(params.base), reaction_s_(params.drive.reaction_s) {}

  /// `preferred_side`: that of a detour, or none.
  TurnCommand step(const TurnInput& input, Side preferred_side);

  /// Waits before the next try, as after a full rotation.
  void pause(time::Timestamp stamp);

  [[nodiscard]] bool is_active() const { return active_; }
  [[nodiscard]] bool backs_up() const { return backs_up_; }
  [[nodiscard]] Side side() const { return side_; }
  void end() { active_ = false; }

 private:
  void begin(const TurnInput& input, Side preferred_side);
  void consider_room(const TurnInput& input);
  [[nodiscard]] TurnCommand rotate(const TurnInput& input);

  TurnParams params_;
  BaseParams base_params_;
  double reaction_s_;
  bool active_ = false;
  Side side_ = Side::kLeft;
  bool reversed_ = false;
  bool backs_up_ = false;
  double last_heading_rad_ = 0.0;
  double rotated_rad_ = 0.0;
  double least_rotation_rad_ = 0.0;  ///< before ahead counts as free
  std::optional<time::Timestamp> waits_since_;
};

}  // namespace nodmap::navigator
