// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/robot/stopping.hpp"

namespace nodmap::navigator {
namespace {

/// Slower than this is standing: a step of the base's speed command is 1 cm/s.
constexpr double kStandingMps = 0.04;
/// Slower than this it does not set out: better to turn.
constexpr double kLeastSpeedMps = 0.06;
/// The side it turned to last is kept for so far: what made it turn is still there.
constexpr double kSameObstacleM = 0.7;
/// A free direction on the other side must be nearer by so much to change the side.
constexpr double kOtherSideRad = geometry::deg_to_rad(30.0);
/// Room kept beside and behind when it goes back over its own trail.
constexpr double kBackMarginM = 0.02;
/// So near to the turning circle something that comes nearer is given way to: who walks at 1.5 m/s
/// is there in 0.4 s, and a turn ends in 0.2 s. Driving, it is so much farther as the robot drives
/// in the time it takes to stand from 1.5 m/s.
constexpr double kGiveWayM = 0.6;
constexpr double kGiveWayS = 0.5;
/// On its way back a turn shorter than this does not help.
constexpr double kLeastTurnRad = geometry::deg_to_rad(2.0);
/// Going back, it makes so much more room: what was just enough is not when odometry slips a
/// little.
constexpr double kRoomToTurnM = 0.03;
/// Where it cannot turn to the heading of its trail at all, as between the feet of people, it goes
/// straight back if it is off by no more than this. Within the 8 cm to the next pose of the trail
/// that leads 6 cm aside: the room it kept there.
constexpr double kObliqueRad = geometry::deg_to_rad(45.0);

constexpr double kEndless = std::numeric_limits<double>::infinity();

double distance(const geometry::SE2& a, const geometry::SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

double widest_way(const FreeSpace& space) {
  return *std::ranges::max_element(space.way_m);
}

}  // namespace

Navigator::Navigator(const NavigatorParams& params)
    : params_(params),
      body_(params.robot.body.footprint()),
      view_(params.view_half_rad),
      approach_(params.half_sweeps_to_trust),
      turn_(params) {}

void Navigator::reset() {
  *this = Navigator(params_);
}

Decision Navigator::halt(std::string reason) {
  view_.forget();
  Decision decision;
  decision.reason = std::move(reason);
  return decision;
}

Decision Navigator::decide(const Situation& now) {
  watch(now);
  if (!back_up_began_at_) {
    trail_.record(now.T_odom_base);
  }
  arrived_ = now.goal && has_arrived(*now.goal, arrived_);
  if (arrived_) {
    turn_.end();
    detour_.end();
    Decision stand = brake(now, "");
    stand.behaviour = Behaviour::kArrived;
    return stand;
  }
  if (approach_.is_close(now.utime_us)) {
    return give_way(now);
  }
  const FreeSpace space = measure_free_space(now.points_base, body_, params_.side_margin_m);
  const FreeSpace trusted_space = trusted(space, now);
  if (!turn_.is_active()) {
    if (std::min(now.max_forward_mps, params_.max_forward_mps) < kLeastSpeedMps) {
      return brake(now, "The pitch controller allows no speed.");
    }
    const auto direction_rad = steering_direction(steering_space(trusted_space, now), now);
    if (direction_rad) {
      if (const auto steered = steer(*direction_rad, now)) {
        return *steered;
      }
    }
    if (std::abs(now.forward_mps) > kStandingMps) {
      return brake(now, "There is an obstacle ahead.");
    }
  }
  return turn(space, trusted_space, now);
}

void Navigator::watch(const Situation& now) {
  view_.look(now.T_odom_base.yaw, now.sweep_count);
  const double reach_m = std::hypot(body_.half_length_m, body_.half_width_m) + kGiveWayM +
                         kGiveWayS * std::max(0.0, now.forward_mps);
  approach_.look(now.utime_us, now.T_odom_base, reach_m, now.points_base, view_);
}

bool Navigator::is_trusted(double direction_rad, const Situation& now) const {
  return view_.trusts(direction_rad, now.laser_is_held ? 0 : params_.half_sweeps_to_trust);
}

FreeSpace Navigator::trusted(const FreeSpace& space, const Situation& now) const {
  FreeSpace seen = space;
  for (int degree = -FreeSpace::kHalf; degree <= FreeSpace::kHalf; ++degree) {
    if (!is_trusted(FreeSpace::angle_rad(degree), now)) {
      seen.at(degree) = 0.0;
    }
  }
  return seen;
}

// ---- Steer ----

/// The robot is steered along ways on which it can also turn; where there are none, along those it
/// fits through.
FreeSpace Navigator::steering_space(const FreeSpace& trusted_space, const Situation& now) const {
  const double turning_circle_m = std::hypot(body_.half_length_m, body_.half_width_m);
  const FreeSpace wide =
      trusted(measure_free_space(now.points_base, body_,
                                 turning_circle_m + params_.turn_margin_m - body_.half_width_m),
              now);
  return widest_way(wide) >= params_.turn_until_free_m ? wide : trusted_space;
}

std::optional<double> Navigator::steering_direction(const FreeSpace& space, const Situation& now) {
  const double widest_m = widest_way(space);
  if (widest_m < params_.robot.braking.stop_margin_m) {
    return std::nullopt;
  }
  // In narrow places the best there is must do.
  const double needed_m = std::min(params_.open_space_m, 0.8 * widest_m);
  return now.goal ? detour_.direction(space, now.points_base, *now.goal, needed_m)
                  : roaming_direction(space, needed_m);
}

std::optional<double> Navigator::roaming_direction(const FreeSpace& space, double needed_m) {
  const auto alpha_rad = free_space_orientation(space, 0.0, params_.open_space_m);
  const FreeNeighbours near = free_neighbours(space, alpha_rad.value_or(0.0), needed_m);
  if (!near.left_rad || !near.right_rad || *near.left_rad == *near.right_rad) {
    const auto only = near.left_rad ? near.left_rad : near.right_rad;
    const bool straight_on = near.left_rad && near.right_rad;
    roaming_side_ = straight_on ? 0.0 : (near.left_rad ? 1.0 : -1.0);
    return only;
  }
  // Something is in the way of alpha: round it on the side begun with.
  const double left_turn_rad = *near.left_rad - alpha_rad.value_or(0.0);
  const double right_turn_rad = alpha_rad.value_or(0.0) - *near.right_rad;
  const double left = left_turn_rad - (roaming_side_ > 0.0 ? kOtherSideRad : 0.0);
  const double right = right_turn_rad - (roaming_side_ < 0.0 ? kOtherSideRad : 0.0);
  roaming_side_ = left <= right ? 1.0 : -1.0;
  return roaming_side_ > 0.0 ? near.left_rad : near.right_rad;
}

Navigator::Arc Navigator::measure_arc(double curvature, const Situation& now) const {
  const double way_m = free_way(now.points_base, curvature, body_, params_.side_margin_m);
  return {curvature, way_m,
          robot::stoppable_speed(way_m - params_.robot.braking.stop_margin_m, params_.reaction_s,
                                 params_.robot.braking.deceleration_mps2)};
}

/// The arc whose chord leads in the direction (pure pursuit); a flatter one where that is blocked.
std::optional<Navigator::Arc> Navigator::arc_towards(double direction_rad,
                                                     const Situation& now) const {
  const double chord_m =
      now.goal ? std::clamp(now.goal->distance_m, 0.2, params_.chord_m) : params_.chord_m;
  const double curvature = 2.0 * std::sin(direction_rad) / chord_m;
  for (const double share : {1.0, 0.5, 0.0}) {
    const Arc arc = measure_arc(share * curvature, now);
    if (arc.speed_mps >= kLeastSpeedMps) {
      return arc;
    }
  }
  return std::nullopt;
}

/// The arc the robot is on now is the one on which it would brake: what it allows, too, must hold.
double Navigator::speed_now_allowed(const Situation& now) const {
  if (now.forward_mps < kLeastSpeedMps) {
    return kEndless;
  }
  const Arc arc = measure_arc(now.yaw_rate_rad_s / now.forward_mps, now);
  const double emergency_mps =
      robot::stoppable_speed(arc.way_m - params_.robot.braking.stop_margin_m, 0.0,
                             params_.robot.braking.emergency_deceleration_mps2);
  return now.forward_mps > emergency_mps ? 0.0 : arc.speed_mps;
}

std::optional<Decision> Navigator::steer(double direction_rad, const Situation& now) const {
  const auto arc = arc_towards(direction_rad, now);
  if (!arc) {
    return std::nullopt;
  }
  const double limit_mps =
      speed_on_arc(arc->curvature, {std::min(now.max_forward_mps, params_.max_forward_mps),
                                    params_.max_yaw_rate_rad_s, params_.max_lateral_mps2});
  // At the goal the robot is to stand, too.
  const double goal_mps = now.goal
                              ? robot::stoppable_speed(now.goal->distance_m, params_.reaction_s,
                                                       params_.robot.braking.deceleration_mps2)
                              : limit_mps;
  const double way_mps = std::min(arc->speed_mps, speed_now_allowed(now));
  Decision decision;
  decision.behaviour = way_mps < limit_mps ? Behaviour::kBrake : Behaviour::kSteer;
  decision.reason = way_mps < limit_mps ? "Slows down for an obstacle." : "";
  decision.forward_mps = std::min({limit_mps, goal_mps, way_mps});
  decision.yaw_rate_rad_s = decision.forward_mps * arc->curvature;
  decision.steering_angle_rad = direction_rad;
  decision.free_way_m = arc->way_m;
  decision.max_forward_mps = std::min(limit_mps, way_mps);
  return decision;
}

// ---- Brake ----

Decision Navigator::brake(const Situation& now, std::string reason) const {
  Decision decision;
  decision.behaviour = Behaviour::kBrake;
  decision.reason = std::move(reason);
  decision.free_way_m = measure_arc(0.0, now).way_m;
  return decision;
}

Decision Navigator::give_way(const Situation& now) const {
  Decision stand = brake(now, "Something comes near: stands until it has passed.");
  stand.behaviour = turn_.is_active() ? Behaviour::kTurn : Behaviour::kBrake;
  return stand;
}

// ---- Turn ----

double Navigator::preferred_side(const Situation& now) const {
  if (now.goal && detour_.side() != 0.0) {
    return detour_.side();
  }
  const bool same_obstacle =
      turn_ended_at_ && distance(*turn_ended_at_, now.T_odom_base) < kSameObstacleM;
  return same_obstacle ? turn_.side() : 0.0;
}

TurnView Navigator::look_around(const FreeSpace& space, const FreeSpace& trusted_space,
                                const Situation& now) const {
  const FreeNeighbours near = free_neighbours(trusted_space, 0.0, params_.turn_until_free_m);
  TurnView view;
  view.utime_us = now.utime_us;
  view.heading_rad = now.T_odom_base.yaw;
  view.yaw_rate_rad_s = now.yaw_rate_rad_s;
  if (near.left_rad && near.right_rad && *near.left_rad == -*near.right_rad) {
    view.free_direction_rad.reset();
  } else if (near.left_rad && (!near.right_rad || *near.left_rad < -*near.right_rad)) {
    view.free_direction_rad = near.left_rad;
  } else {
    view.free_direction_rad = near.right_rad;
  }
  view.more_room_side = side_with_more_room(space);
  view.ahead_is_free = space.at(0) >= params_.turn_until_free_m &&
                       measure_arc(0.0, now).way_m >= params_.turn_until_free_m;
  view.ahead_was_seen = is_trusted(0.0, now);
  const FreeNeighbours looks_free = free_neighbours(space, 0.0, params_.turn_until_free_m);
  const double margin_m = params_.turn_margin_m + (turn_.backs_up() ? kRoomToTurnM : 0.0);
  view.left = {free_turn(now.points_base, 1.0, body_, margin_m),
               looks_free.left_rad.value_or(kEndless)};
  view.right = {free_turn(now.points_base, -1.0, body_, margin_m),
                looks_free.right_rad ? -*looks_free.right_rad : kEndless};
  view.knows_way_back = trail_.way_back(now.T_odom_base).has_value();
  return view;
}

Decision Navigator::turn(const FreeSpace& space, const FreeSpace& trusted_space,
                         const Situation& now) {
  const TurnCommand command =
      turn_.step(look_around(space, trusted_space, now), preferred_side(now));
  if (now.goal) {
    detour_.begin(turn_.side(), *now.goal);
  }
  if (command.kind == TurnCommand::Kind::kBackUp) {
    return back_up(now);
  }
  back_up_began_at_.reset();
  Decision decision = brake(now, "");
  decision.behaviour = Behaviour::kTurn;
  decision.yaw_rate_rad_s = command.yaw_rate_rad_s;
  decision.steering_angle_rad = turn_.side() * 0.5 * geometry::kPi;
  switch (command.kind) {
    case TurnCommand::Kind::kTurn:
      decision.reason = "Turns to a free direction.";
      break;
    case TurnCommand::Kind::kLook:
      decision.reason = "Waits until the laser has seen what is ahead.";
      break;
    case TurnCommand::Kind::kWait:
      decision.reason = "No direction is free; will try again.";
      break;
    default:
      turn_.end();
      turn_ended_at_ = now.T_odom_base;
      decision.reason = "The way ahead is free.";
  }
  return decision;
}

Decision Navigator::back_up(const Situation& now) {
  Decision decision = brake(now, "");
  decision.behaviour = Behaviour::kTurn;
  if (!back_up_began_at_) {
    back_up_began_at_ = now.T_odom_base;
  }
  const auto way_back = trail_.way_back(now.T_odom_base);
  const double side = way_back ? std::copysign(1.0, way_back->turn_rad) : 1.0;
  const double free_rad = free_turn(now.points_base, side, body_, params_.turn_margin_m);
  const bool can_turn = free_rad >= kLeastTurnRad;
  if (!way_back || (!can_turn && std::abs(way_back->turn_rad) > kObliqueRad) ||
      distance(*back_up_began_at_, now.T_odom_base) >= params_.back_up_m) {
    turn_.pause(now.utime_us);
    back_up_began_at_.reset();
    decision.reason = "Cannot turn, and the way back is not known to be free.";
    return decision;
  }
  decision.reason = "Cannot turn: goes back along its trail.";
  if (way_back->turn_rad != 0.0 && can_turn) {
    decision.yaw_rate_rad_s =
        side * turn_rate(std::min(std::abs(way_back->turn_rad), free_rad), params_);
    return decision;
  }
  trail_.retreat(now.T_odom_base);
  const double way_m =
      free_way_behind(now.points_base, way_back->curvature, body_, kBackMarginM) - kBackMarginM;
  decision.forward_mps = -std::min(
      params_.back_up_mps,
      robot::stoppable_speed(way_m, params_.reaction_s, params_.robot.braking.deceleration_mps2));
  decision.yaw_rate_rad_s = decision.forward_mps * way_back->curvature;
  return decision;
}

}  // namespace nodmap::navigator
