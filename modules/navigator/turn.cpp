// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/turn.hpp"

#include <algorithm>
#include <cmath>

#include "common/robot/stopping.hpp"

namespace nodmap::navigator {
namespace {

using Kind = TurnCommand::Kind;

/// A turn shorter than this is not worth beginning, and one that comes so near to an obstacle ends.
constexpr double kLeastTurnRad = geometry::deg_to_rad(5.0);
/// Having begun to back up, it goes on until so much of a turn is free: less has just been tried.
constexpr double kWorthwhileTurnRad = geometry::deg_to_rad(150.0);
/// Deceleration of a turn, a third of what the wheels can do.
constexpr double kTurnDecelerationRadS2 = 5.0;
/// Having gone back, it turns away at least so far.
constexpr double kTurnAwayRad = geometry::deg_to_rad(60.0);
constexpr double kStandingRadS = 0.1;
/// A free direction is free a little further on, too; and the base's slowest turn is 0.05 rad/s.
constexpr double kTurnBeyondRad = geometry::deg_to_rad(3.0);
constexpr double kWholeTurnRad = 2.0 * geometry::kPi;

bool leads_out(const TurnView::Side& side) {
  return side.free_turn_rad >= std::min(side.until_free_rad, kWorthwhileTurnRad);
}

}  // namespace

void Turn::begin(const TurnView& view, double preferred_side) {
  active_ = true;
  reversed_ = false;
  backs_up_ = false;
  turned_rad_ = 0.0;
  least_turn_rad_ = 0.0;
  last_heading_rad_ = view.heading_rad;
  waits_since_us_.reset();
  if (preferred_side != 0.0) {
    side_ = preferred_side;
  } else if (view.free_direction_rad) {
    side_ = *view.free_direction_rad >= 0.0 ? 1.0 : -1.0;
  } else {
    // As much room on both sides: to the left.
    side_ = view.more_room_side >= 0.0 ? 1.0 : -1.0;
  }
  consider_room(view);
}

/// A turn that ends at an obstacle, and then one to the other side that does, too, lead nowhere.
void Turn::consider_room(const TurnView& view) {
  const bool here = leads_out(side_ > 0.0 ? view.left : view.right);
  const bool there = leads_out(side_ > 0.0 ? view.right : view.left);
  if (!here && there) {
    side_ = -side_;
    reversed_ = true;
  }
  backs_up_ = !here && !there && view.knows_way_back;
}

TurnCommand Turn::step(const TurnView& view, double preferred_side) {
  const bool wants_retry =
      waits_since_us_ &&
      1e-6 * static_cast<double>(view.utime_us - *waits_since_us_) > params_.retry_s;
  if (!active_ || wants_retry) {
    begin(view, preferred_side);
  }
  turned_rad_ += geometry::angle_difference(view.heading_rad, last_heading_rad_);
  last_heading_rad_ = view.heading_rad;
  if (view.ahead_is_free && !backs_up_ && std::abs(turned_rad_) >= least_turn_rad_) {
    const bool stands = std::abs(view.yaw_rate_rad_s) < kStandingRadS;
    return {view.ahead_was_seen && stands ? Kind::kFinished : Kind::kLook, 0.0};
  }
  // A stamp that stepped back must not prolong the pause.
  if (waits_since_us_) {
    waits_since_us_ = std::min(*waits_since_us_, view.utime_us);
    return {Kind::kWait, 0.0};
  }
  if (std::abs(turned_rad_) >= kWholeTurnRad) {
    pause(view.utime_us);
    return {Kind::kWait, 0.0};
  }
  return turn_on(view);
}

void Turn::pause(std::int64_t utime_us) {
  waits_since_us_ = utime_us;
  backs_up_ = false;
}

TurnCommand Turn::turn_on(const TurnView& view) {
  const auto here = [&]() -> const TurnView::Side& { return side_ > 0.0 ? view.left : view.right; };
  const double needed_rad = backs_up_ ? kWorthwhileTurnRad : kLeastTurnRad;
  if (here().free_turn_rad < needed_rad && (!reversed_ || backs_up_)) {
    side_ = -side_;
    reversed_ = true;
    turned_rad_ = 0.0;
  }
  backs_up_ = here().free_turn_rad < needed_rad;
  if (backs_up_) {
    // What is ahead then is the place it could not turn in: not into it again.
    turned_rad_ = 0.0;
    least_turn_rad_ = kTurnAwayRad;
    return {Kind::kBackUp, 0.0};
  }
  // Slower towards the end of the turn, so that it does not turn past the free direction.
  const double until_free_rad =
      std::max(here().until_free_rad, least_turn_rad_ - std::abs(turned_rad_));
  const double way_rad = std::min(here().free_turn_rad, until_free_rad + kTurnBeyondRad);
  return {Kind::kTurn, side_ * turn_rate(way_rad, params_)};
}

double turn_rate(double way_rad, const NavigatorParams& params) {
  return std::min(params.turn_rate_rad_s,
                  robot::stoppable_speed(way_rad, params.reaction_s, kTurnDecelerationRadS2));
}

}  // namespace nodmap::navigator
