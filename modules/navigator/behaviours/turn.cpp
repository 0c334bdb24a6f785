// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/turn.hpp"

#include <algorithm>
#include <cmath>

#include "modules/navigator/behaviours/brake.hpp"

namespace nodmap::navigator {
namespace {

using Kind = TurnCommand::Kind;

// A rotation ends this far before an obstacle; a shorter one is not begun.
constexpr double kMinTurnRad = geometry::deg_to_rad(5.0);
// Backs up until it can rotate this far. Less has just been tried.
constexpr double kWorthwhileRotationRad = geometry::deg_to_rad(150.0);
// After backing up it rotates at least this far.
constexpr double kTurnAwayRad = geometry::deg_to_rad(60.0);
constexpr double kStationaryRadS = 0.1;
// Rotates this far beyond the first free direction: the base's slowest yaw rate is 0.05 rad/s.
constexpr double kBeyondRad = geometry::deg_to_rad(3.0);
constexpr double kFullRotationRad = 2.0 * geometry::kPi;

bool leads_out(const TurnInput::Room& room) {
  return room.free_rotation_rad >= std::min(room.to_clear_direction_rad, kWorthwhileRotationRad);
}

}  // namespace

void Turn::begin(const TurnInput& input, Side preferred_side) {
  active_ = true;
  reversed_ = false;
  backs_up_ = false;
  rotated_rad_ = 0.0;
  least_rotation_rad_ = 0.0;
  last_heading_rad_ = input.heading_rad;
  waits_since_.reset();
  if (preferred_side != Side::kNone) {
    side_ = preferred_side;
  } else if (input.clear_direction_rad) {
    side_ = *input.clear_direction_rad >= 0.0 ? Side::kLeft : Side::kRight;
  } else {
    // With the same room on both sides it turns left.
    side_ = input.more_room_side == Side::kRight ? Side::kRight : Side::kLeft;
  }
  consider_room(input);
}

// Changes the side, or decides to back up, if obstacles end the rotation before a free direction.
void Turn::consider_room(const TurnInput& input) {
  const bool here = leads_out(input.on(side_));
  const bool there = leads_out(input.on(opposite(side_)));
  if (!here && there) {
    side_ = opposite(side_);
    reversed_ = true;
  }
  backs_up_ = !here && !there && input.has_path_back;
}

TurnCommand Turn::step(const TurnInput& input, Side preferred_side) {
  const bool wants_retry =
      waits_since_ && time::seconds(input.stamp - *waits_since_) > params_.retry_s;
  if (!active_ || wants_retry) {
    begin(input, preferred_side);
  }
  rotated_rad_ += geometry::angle_difference(input.heading_rad, last_heading_rad_);
  last_heading_rad_ = input.heading_rad;
  if (input.ahead_is_free && !backs_up_ && std::abs(rotated_rad_) >= least_rotation_rad_) {
    const bool is_stationary = std::abs(input.yaw_rate_rad_s) < kStationaryRadS;
    return {input.ahead_is_seen && is_stationary ? Kind::kFinished : Kind::kLook, 0.0};
  }
  // A stamp that stepped back must not prolong the pause.
  if (waits_since_) {
    waits_since_ = std::min(*waits_since_, input.stamp);
    return {Kind::kWait, 0.0};
  }
  if (std::abs(rotated_rad_) >= kFullRotationRad) {
    pause(input.stamp);
    return {Kind::kWait, 0.0};
  }
  return rotate(input);
}

void Turn::pause(time::Timestamp stamp) {
  waits_since_ = stamp;
  backs_up_ = false;
}

TurnCommand Turn::rotate(const TurnInput& input) {
  const double needed_rad = backs_up_ ? kWorthwhileRotationRad : kMinTurnRad;
  if (input.on(side_).free_rotation_rad < needed_rad && (!reversed_ || backs_up_)) {
    side_ = opposite(side_);
    reversed_ = true;
    rotated_rad_ = 0.0;
  }
  backs_up_ = input.on(side_).free_rotation_rad < needed_rad;
  if (backs_up_) {
    // After backing up, the place where it could not turn is ahead: it must rotate away from there.
    rotated_rad_ = 0.0;
    least_rotation_rad_ = kTurnAwayRad;
    return {Kind::kBackUp, 0.0};
  }
  // Slower towards the end, so that it does not rotate past the free direction.
  const double to_clear_direction_rad = std::max(input.on(side_).to_clear_direction_rad,
                                                 least_rotation_rad_ - std::abs(rotated_rad_));
  const double angle_rad =
      std::min(input.on(side_).free_rotation_rad, to_clear_direction_rad + kBeyondRad);
  return {Kind::kTurn,
          sign(side_) * rate_to_stop_within_rad_s(angle_rad, params_, base_params_, reaction_s_)};
}

}  // namespace nodmap::navigator
