// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nodmap::navigator {
namespace {

// Slower than this counts as stationary: four steps of the base's speed command.
constexpr double kStationaryMps = 0.04;
// Within this distance of its last turn the robot turns to the same side: the obstacle is the
// same.
constexpr double kSameObstacleM = 0.7;
// Added to the turn margin while backing up, so that the room still suffices if odometry slips a
// little.
constexpr double kRoomToTurnM = 0.03;

// The plan avoids places so far to the left and right of a contact: where the robot would pass it
// with its side.
constexpr double kBesideContactM = 0.45;

constexpr double kEndless = std::numeric_limits<double>::infinity();

// The nearer of two free directions, positive left; empty if there is none or both are equally
// near.
std::optional<double> nearer_direction(const FreeNeighbours& near) {
  if (near.left_rad && near.right_rad && *near.left_rad == -*near.right_rad) {
    return std::nullopt;
  }
  const bool is_left = near.left_rad && (!near.right_rad || *near.left_rad < -*near.right_rad);
  return is_left ? near.left_rad : near.right_rad;
}

}  // namespace

Navigator::Navigator(const NavigatorParams& params)
    : params_(params),
      body_(params.robot.body.footprint()),
      surroundings_(params),
      steering_(params),
      brake_(params),
      turn_(params),
      trail_(params.local_map.forget_after_m),
      back_up_(params),
      goal_drive_(params),
      roaming_(params),
      leave_contact_(params) {}

void Navigator::reset() {
  *this = Navigator(params_);
}

void Navigator::forget_map() {
  contacts_map_.clear();
  goal_drive_.forget_map();
  roaming_.forget_map();
}

Decision Navigator::halt(Reason reason) {
  surroundings_.forget_seen();
  return halted(std::move(reason));
}

Decision Navigator::pause(Reason reason) {
  surroundings_.miss_scans();
  return halted(std::move(reason));
}

Decision Navigator::decide(Situation now) {
  if (auto stops = stop_at_contact(now)) {
    return *stops;
  }
  surroundings_.complete(now);
  record_drive(now);
  Decision decision = behave(now);
  if (!leave_contact_.is_active()) {
    remember_contacts(now);
  }
  brake_.keep_to_known_ground(decision, now);
  // Plans count only people who walk for certain; Brake also counts those who have just appeared.
  surroundings_.add_newcomers(now);
  brake_.give_way(decision, now);
  return decision;
}

// Once the wheels are stationary, begins anew what has a place in odom: while they slipped,
// odometry counted a motion that was none. Plans are in map.
std::optional<Decision> Navigator::stop_at_contact(const Situation& now) {
  if (!leave_contact_.is_stopping()) {
    return std::nullopt;
  }
  if (const auto contact_odom = leave_contact_.take_contact(now)) {
    surroundings_.begin_anew();
    trail_ = Trail(params_.local_map.forget_after_m);
    back_up_ = BackUp(params_);
    end_turn();
    turn_ended_at_.reset();
    fresh_contacts_odom_.push_back(*contact_odom);
    for (const Contact& fresh_odom : fresh_contacts_odom_) {
      surroundings_.add_contact(fresh_odom);
    }
  }
  return stationary(Why::kTouches);
}

// Once the robot has left what it touched, 2D SLAM has found where it is: the contact has its place
// in map, and earlier ones have their new place in odom. What was touched is probably wider than
// the body, so the plan prefers to pass it at some distance.
void Navigator::remember_contacts(const Situation& now) {
  constexpr std::size_t kMaxContacts = 50;
  if (fresh_contacts_odom_.empty()) {
    return;
  }
  const geometry::SE2 T_odom_map = now.T_map_odom.inverse();
  for (const Contact& contact_map : contacts_map_) {
    surroundings_.add_contact({T_odom_map * contact_map.T_base, contact_map.at_front});
  }
  for (const Contact& contact_odom : std::exchange(fresh_contacts_odom_, {})) {
    const geometry::SE2 T_map_contact = now.T_map_odom * contact_odom.T_base;
    contacts_map_.push_back({T_map_contact, contact_odom.at_front});
    const double x = (contact_odom.at_front ? 1.0 : -1.0) * body_.half_length_m;
    for (const double y : {-kBesideContactM, kBesideContactM}) {
      goal_drive_.avoid(T_map_contact * Eigen::Vector2d(x, y));
    }
  }
  while (contacts_map_.size() > kMaxContacts) {
    contacts_map_.pop_front();
  }
}

void Navigator::record_drive(Situation& now) {
  back_up_.record(now.T_odom_base, now.forward_mps);
  trail_.move(now.T_odom_base);
  if (now.forward_mps > -kReversingMps) {
    trail_.record(now.T_odom_base);
  }
  now.trail = &trail_;
}

Decision Navigator::behave(const Situation& now) {
  if (!now.goal) {
    goal_drive_.forget_goal();
  }
  watch_arrival(now);
  if (arrived_map_) {
    end_turn();
    steering_.detour().end();
    return arrive(now);
  }
  if (auto reason = surroundings_.reason_to_wait(now.stamp)) {
    return wait(now, std::move(*reason));
  }
  if (now.max_forward_mps < kMinSpeedMps) {
    return wait(now, Why::kNoSpeed);
  }
  if (const auto leaves = leave_contact_.step(now)) {
    return *leaves;
  }
  if (now.goal && drives_by_plan(now)) {
    end_turn();
    watch_first_look(now);
    return has_looked_ ? goal_drive_.decide(now) : slow_down(now, Why::kFirstLook);
  }
  if (!turn_.is_active()) {
    if (const auto decision = drive_ahead(now)) {
      return *decision;
    }
  }
  return turn(now);
}

// Stops within the tolerance. What the robot must wait for stops it at once here, too.
Decision Navigator::arrive(const Situation& now) const {
  Decision decision = slow_down(now, Why::kNothingToAdd);
  if (surroundings_.reason_to_wait(now.stamp) ||
      decision.forward_mps > brake_.stoppable_mps(now.goal->exit_distance_m())) {
    decision = brake(now, Why::kNothingToAdd);
  }
  decision.behaviour = Behaviour::kArrived;
  return decision;
}

bool Navigator::drives_by_plan(const Situation& now) const {
  return now.local_map != nullptr && (now.goal ? params_.planner.use : params_.planner.roams);
}

// Roams by plan, or steers, as far as there is room; empty when the robot is stationary and must
// turn to go on.
std::optional<Decision> Navigator::drive_ahead(const Situation& now) {
  const bool roams = drives_by_plan(now);
  if (roams) {
    watch_first_look(now);
    if (!has_looked_) {
      return slow_down(now, Why::kFirstLook);
    }
  }
  if (auto decision = roams ? roaming_.decide(now) : steering_.steer(now)) {
    return decision;
  }
  if (std::abs(now.forward_mps) > kStationaryMps) {
    return brake(now, Why::kObstacleAhead);
  }
  return std::nullopt;
}

// A dock is reached otherwise. At another goal the robot must arrive anew.
void Navigator::watch_arrival(const Situation& now) {
  if (!now.goal || now.goal->heading) {
    arrived_map_.reset();
    return;
  }
  constexpr double kSameM = 1e-3;  // rounding, by the motion since
  const Eigen::Vector2d goal_map = now.T_map_odom * (now.T_odom_base * now.goal->p_base);
  const bool had_arrived = arrived_map_ && (goal_map - *arrived_map_).norm() < kSameM;
  arrived_map_ = has_arrived(*now.goal, had_arrived) ? std::optional(goal_map) : std::nullopt;
}

// A goal takes over.
void Navigator::end_turn() {
  turn_.end();
  back_up_.end();  // otherwise the trail would not be recorded
}

// Before the laser has looked ahead the robot must not turn away from a ramp, which looks like an
// obstacle in the first scans.
void Navigator::watch_first_look(const Situation& now) {
  has_looked_ = has_looked_ || now.has_seen(0.0);
}

Decision Navigator::brake(const Situation& now, Reason reason) const {
  return with_free_distance(stationary(std::move(reason)), now);
}

Decision Navigator::slow_down(const Situation& now, Reason reason) const {
  return with_free_distance(brake_.slow_down(std::move(reason), now), now);
}

Decision Navigator::with_free_distance(Decision decision, const Situation& now) const {
  decision.free_distance_m =
      free_distance(now.points_base, 0.0, body_, params_.drive.side_margin_m);
  return decision;
}

Decision Navigator::wait(const Situation& now, Reason reason) const {
  Decision decision = brake(now, std::move(reason));
  decision.behaviour = turn_.is_active() ? Behaviour::kTurn : Behaviour::kBrake;
  return decision;
}

Decision Navigator::turn(const Situation& now) {
  const TurnCommand command = turn_.step(turn_input(now), preferred_side(now));
  if (now.goal) {
    steering_.detour().begin(turn_.side(), *now.goal);
  }
  if (command.kind == TurnCommand::Kind::kBackUp) {
    return back_up(now);
  }
  back_up_.end();
  Decision decision = brake(now, Why::kNothingToAdd);
  decision.behaviour = Behaviour::kTurn;
  decision.yaw_rate_rad_s = command.yaw_rate_rad_s;
  decision.steering_angle_rad = sign(turn_.side()) * 0.5 * geometry::kPi;
  switch (command.kind) {
    case TurnCommand::Kind::kTurn:
      decision.reason = Why::kTurnsToFree;
      break;
    case TurnCommand::Kind::kLook:
      decision.reason = Why::kLooksAhead;
      break;
    case TurnCommand::Kind::kWait:
      decision.reason = Why::kNoFreeDirection;
      break;
    case TurnCommand::Kind::kBackUp:  // decided above
    case TurnCommand::Kind::kFinished:
      turn_.end();
      turn_ended_at_ = now.T_odom_base;
      decision.reason = Why::kFreeAhead;
      break;
  }
  return decision;
}

TurnInput Navigator::turn_input(const Situation& now) const {
  const FreeSpace space = measure_free_space(now.points_base, body_, params_.drive.side_margin_m);
  const double until_free_m = params_.turn.until_free_m;
  const FreeNeighbours seen_and_free = free_neighbours(seen_space(space, now), 0.0, until_free_m);
  const FreeNeighbours without_points = free_neighbours(space, 0.0, until_free_m);
  const double margin_m = params_.turn.margin_m + (turn_.backs_up() ? kRoomToTurnM : 0.0);
  TurnInput input;
  input.stamp = now.stamp;
  input.heading_rad = now.T_odom_base.yaw;
  input.yaw_rate_rad_s = now.yaw_rate_rad_s;
  input.clear_direction_rad = nearer_direction(seen_and_free);
  input.more_room_side = side_with_more_room(space);
  input.ahead_is_seen = now.has_seen(0.0);
  input.ahead_is_free = space.at(0) >= until_free_m && brake_lets_ahead(now);
  input.left = {free_rotation(now.points_base, Side::kLeft, body_, margin_m),
                without_points.left_rad.value_or(kEndless)};
  input.right = {free_rotation(now.points_base, Side::kRight, body_, margin_m),
                 without_points.right_rad ? -*without_points.right_rad : kEndless};
  input.has_path_back = back_up_.has_path(now.T_odom_base);
  return input;
}

// Whether Brake would let the robot drive ahead as it does where no obstacle is nearer than Turn
// requires. If Turn ended before ground that Brake does not let it drive on, it would begin again
// at once. What the laser has not looked at yet does not count: Turn looks at it first.
bool Navigator::brake_lets_ahead(const Situation& now) const {
  const double free_mps =
      brake_.stoppable_mps(params_.turn.until_free_m - params_.robot.braking.stop_margin_m);
  return !now.has_seen(0.0) || brake_.measure_arc(0.0, now).speed_mps >=
                                   std::min(free_mps, params_.drive.max_forward_mps);
}

Side Navigator::preferred_side(const Situation& now) {
  if (now.goal && steering_.detour().side() != Side::kNone) {
    return steering_.detour().side();
  }
  const bool is_same_obstacle =
      turn_ended_at_ && geometry::distance_m(*turn_ended_at_, now.T_odom_base) < kSameObstacleM;
  return is_same_obstacle ? turn_.side() : Side::kNone;
}

Decision Navigator::back_up(const Situation& now) {
  Decision decision = brake(now, Why::kBacksUpTrail);
  decision.behaviour = Behaviour::kTurn;
  if (const auto motion = back_up_.step(now, brake_)) {
    decision.forward_mps = motion->forward_mps;
    decision.yaw_rate_rad_s = motion->yaw_rate_rad_s;
  } else {
    turn_.pause(now.stamp);
    decision.reason = Why::kNoWayBack;
  }
  return decision;
}

}  // namespace nodmap::navigator
