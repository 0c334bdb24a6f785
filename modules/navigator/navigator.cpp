// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "modules/navigator/geofence.hpp"

namespace nodmap::navigator {
namespace {

/// Below this speed the robot is stationary: a step of the base's speed command is 1 cm/s.
constexpr double kStationaryMps = 0.04;
/// Within this distance of its last turn the robot turns to the same side: the obstacle is the
/// same.
constexpr double kSameObstacleM = 0.7;
/// The robot waits for what approaches within this distance of its turning circle: a person at
/// 1.5 m/s covers it in 0.4 s, and a rotation stops in 0.2 s. While driving the distance is longer
/// by what the robot covers in the time that it needs to stop from 1.5 m/s.
constexpr double kApproachM = 0.6;
constexpr double kApproachS = 0.5;
/// Added to the turn margin while backing up, so that the room still suffices if odometry slips a
/// little.
constexpr double kRoomToTurnM = 0.03;

/// Doubtful ground counts up to this far beyond the turning circle, because arcs swing the rear
/// out.
constexpr double kDoubtfulM = 0.1;
/// A point this near to the disc of a person belongs to the person, by the error of the track, and
/// so does one near to where the person was within this time: the obstacle map still has the person
/// where earlier sweeps saw them.
constexpr double kOnPersonM = 0.25;
constexpr double kWakeS = 1.0;
/// Obstacles this near to the disc of a person in sight were the person, by the noise of the track.
constexpr double kTrackNoiseM = 0.1;
/// For this long after somebody walked the obstacle map may still contain them.
constexpr time::Duration kPassed = 20s;

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// The nearer of two free directions, positive left; empty if there is none or both are equally
/// near.
std::optional<double> nearer_direction(const FreeNeighbours& near) {
  if (near.left_rad && near.right_rad && *near.left_rad == -*near.right_rad) {
    return std::nullopt;
  }
  const bool is_left = near.left_rad && (!near.right_rad || *near.left_rad < -*near.right_rad);
  return is_left ? near.left_rad : near.right_rad;
}

/// The distance from a point to where a person is now or was within the last second.
double distance_to_wake(const Eigen::Vector2d& p_base, const Person& person) {
  const Eigen::Vector2d back = -kWakeS * person.velocity;
  const Eigen::Vector2d offset = p_base - person.position;
  const double share = std::clamp(offset.dot(back) / std::max(back.squaredNorm(), 1e-9), 0.0, 1.0);
  return (offset - share * back).norm();
}

/// The points that belong to no tracked person. Where people are in the way, and for how long,
/// their tracks say.
Points without(const People& people, Points points_base) {
  std::erase_if(points_base, [&](const Eigen::Vector2d& p_base) {
    return std::ranges::any_of(people, [&](const Person& person) {
      return person.is_in_sight && distance_to_wake(p_base, person) < person.radius_m + kOnPersonM;
    });
  });
  return points_base;
}

}  // namespace

Navigator::Navigator(const NavigatorParams& params)
    : params_(params),
      body_(params.robot.body.footprint()),
      seen_(params.steer.view_half_rad),
      approach_(params.steer.sweeps_to_trust),
      steering_(params),
      brake_(params),
      turn_(params.turn, params.drive.reaction_s),
      back_up_(params),
      local_map_(params.robot, params.local_map),
      goal_drive_(params),
      roaming_(params) {}

void Navigator::reset() {
  *this = Navigator(params_);
}

Decision Navigator::halt(Reason reason) {
  seen_.forget();
  is_in_gap_ = false;
  gap_ended_at_sweep_.reset();
  Decision decision;
  decision.reason = std::move(reason);
  return decision;
}

Decision Navigator::pause(Reason reason) {
  if (!is_in_gap_ && gap_ended_at_sweep_) {
    return halt(std::move(reason));
  }
  seen_.forget_unseen(params_.steer.sweeps_to_trust);
  is_in_gap_ = true;
  Decision decision;
  decision.reason = std::move(reason);
  return decision;
}

void Navigator::add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                         bool laser_is_held) {
  // Nobody is tracked near ramps: while the robot tilts, things that stand still seem to move.
  const bool tracks_people = params_.people.use && local_map_.ground().is_level();
  if (tracks_people) {
    const auto is_blocked = [this](const Eigen::Vector2d& p_odom) {
      const LocalCell* cell = local_map_.cell_at(p_odom);
      return cell != nullptr && cell->is_obstacle();
    };
    people_.add_scan(scan, T_odom_base, is_blocked, laser_is_held);
  }
  if (params_.local_map.use) {
    local_map_.add_scan(scan, T_odom_base,
                        tracks_people ? people_.is_walker() : std::vector<bool>{});
    forget_wakes(scan.mid_stamp());
  }
}

/// Removes the obstacles that people were before it was known that they walk: along the path of the
/// last second of everybody in sight.
void Navigator::forget_wakes(time::Timestamp stamp) {
  constexpr double kStepS = 0.2;
  for (const Person& person : people_.people_odom(stamp)) {
    for (double ago_s = 0.0; ago_s <= kWakeS && person.is_in_sight; ago_s += kStepS) {
      local_map_.forget_walker(person.position_after(-ago_s), person.radius_m + kTrackNoiseM);
    }
  }
}

void Navigator::add_contact(const geometry::SE2& T_odom_base, bool at_front) {
  // On slopes level scans meet the floor, so 2D SLAM may not notice that the robot moves.
  if (local_map_.has_scan() && local_map_.ground().is_level()) {
    local_map_.add_contact(T_odom_base, at_front);
  }
}

void Navigator::add_ranges(time::Timestamp stamp, const Proximity::Ranges& ranges_m,
                           const geometry::SE2& T_odom_base) {
  if (params_.people.use && params_.local_map.use && local_map_.has_scan()) {
    proximity_.add(stamp, ranges_m, T_odom_base, local_map_, people_.people_odom(stamp));
  }
}

Decision Navigator::decide(Situation now) {
  respect_gap(now);
  respect_slopes(now);
  observe(now);
  join_local_map(now);
  join_geofence(now);
  Decision decision = behave(now);
  brake_.keep_to_known_ground(decision, now);
  // Plans count only people who walk for certain; Brake also counts those who have just appeared.
  if (params_.people.use) {
    const People newcomers = people_.newcomers_base(now.stamp, now.T_odom_base);
    now.people.insert(now.people.end(), newcomers.begin(), newcomers.end());
  }
  brake_.give_way(decision, now);
  return decision;
}

Decision Navigator::behave(const Situation& now) {
  arrived_ = now.goal && !now.goal->heading && has_arrived(*now.goal, arrived_);
  if (arrived_) {
    turn_.end();
    steering_.detour().end();
    Decision decision = brake(now, Why::kNothingToAdd);
    decision.behaviour = Behaviour::kArrived;
    return decision;
  }
  if (approach_.is_detected(now.stamp)) {
    return wait(now, Why::kApproach);
  }
  if (proximity_.is_detected(now.stamp)) {
    return wait(now, Why::kSomebodyClose);
  }
  if (now.goal && params_.planner.use && local_map_.has_scan()) {
    turn_.end();
    return has_looked(now) ? goal_drive_.decide(now, seen_, local_map_)
                           : brake(now, Why::kFirstLook);
  }
  const FreeSpace space = measure_free_space(now.points_base, body_, params_.drive.side_margin_m);
  if (!turn_.is_active()) {
    if (const auto decision = drive_ahead(space, now)) {
      return *decision;
    }
  }
  return turn(space, now);
}

/// Roams by plan, or steers, as far as there is room; empty when the robot is stationary and must
/// turn to go on.
std::optional<Decision> Navigator::drive_ahead(const FreeSpace& space, const Situation& now) {
  if (std::min(now.max_forward_mps, params_.drive.max_forward_mps) < kLeastSpeedMps) {
    return brake(now, Why::kNoSpeed);
  }
  const bool roams = params_.planner.roams && !now.goal && local_map_.has_scan();
  if (roams && !has_looked(now)) {
    return brake(now, Why::kFirstLook);
  }
  if (auto decision =
          roams ? roaming_.decide(now, seen_, local_map_) : steering_.steer(space, seen_, now)) {
    return decision;
  }
  if (std::abs(now.forward_mps) > kStationaryMps) {
    return brake(now, Why::kObstacleAhead);
  }
  return std::nullopt;
}

/// Whether the laser has looked ahead since the start. Before that the robot must not turn away
/// from a ramp, which looks like an obstacle in the first scans.
bool Navigator::has_looked(const Situation& now) {
  has_looked_ =
      has_looked_ || now.laser_is_held || seen_.is_seen(0.0, params_.steer.sweeps_to_trust);
  return has_looked_;
}

void Navigator::observe(Situation& now) {
  now.people = people_.people_base(now.stamp, now.T_odom_base);
  seen_.update(now.T_odom_base.yaw, now.sweep_count);
  const double reach_m =
      body_.turning_radius_m() + kApproachM + kApproachS * std::max(0.0, now.forward_mps);
  const bool has_local_map = local_map_.has_scan() && !now.laser_is_held;
  if (!now.people.empty()) {
    saw_people_at_ = now.stamp;
  }
  if (has_local_map && saw_people_at_ && std::chrono::abs(now.stamp - *saw_people_at_) < kPassed) {
    erase_free_floor(now);
  }
  const Points nobodys = without(now.people, now.points_base);
  approach_.update(now.stamp, now.T_odom_base, reach_m, nobodys, seen_,
                   has_local_map ? &local_map_ : nullptr);
  if (local_map_.has_scan()) {
    now.points_base = nobodys;  // what stands beside a person is also in the local map
  }
  back_up_.record(now.T_odom_base);
}

/// After a gap in the scans shorter than a sweep, halves the speed bound for two sweeps. Why the
/// robot need not stand and look: what it had looked at before is in its maps, and where no floor
/// was seen Brake stops it as always. Only what has come since could be missed. The gap costs each
/// place one look, or the two at one end of the sweep. So no place is unseen for longer than twice
/// the time for which the pitch controller's bound holds, and at half of the bound the robot drives
/// no farther in it than it may without a gap. After two sweeps every place has been looked at.
void Navigator::respect_gap(Situation& now) {
  constexpr double kShareOfBound = 0.5;
  if (is_in_gap_) {
    is_in_gap_ = false;
    gap_ended_at_sweep_ = now.sweep_count;
  }
  if (gap_ended_at_sweep_ &&
      std::abs(now.sweep_count - *gap_ended_at_sweep_) >= params_.steer.sweeps_to_trust) {
    gap_ended_at_sweep_.reset();
  }
  if (gap_ended_at_sweep_) {
    now.max_forward_mps *= kShareOfBound;
  }
}

/// Slows down near slopes, and removes points of the obstacle map that are ground. That map
/// measures heights above the plane on which the robot stands, so it takes sloped ground for
/// obstacles; the local map, made from the same scans, knows better.
void Navigator::respect_slopes(Situation& now) const {
  if (!local_map_.has_scan() || local_map_.ground().is_level()) {
    return;
  }
  now.max_forward_mps = std::min(now.max_forward_mps, params_.local_map.ground.sloped_mps);
  erase_free_floor(now);
}

/// Removes points of the obstacle map where the local map, made from the same scans, knows only
/// floor: slopes, and people who have passed beside or behind the robot.
void Navigator::erase_free_floor(Situation& now) const {
  std::erase_if(now.points_base, [&](const Eigen::Vector2d& p_base) {
    return local_map_.is_free_floor(now.T_odom_base * p_base);
  });
}

/// Adds the obstacles of the local map. Must follow observe(): a low sill that is first seen when
/// it is near has not approached.
void Navigator::join_local_map(Situation& now) const {
  if (!local_map_.has_scan()) {
    return;
  }
  // A laser that is held level sees no floor, so only its points count.
  now.local_map = now.laser_is_held ? nullptr : &local_map_;
  const Points more = local_map_.points_base(now.T_odom_base, params_.local_map.range_m);
  now.points_base.insert(now.points_base.end(), more.begin(), more.end());
  if (now.local_map != nullptr) {
    now.doubtful_base =
        local_map_.doubtful_points_base(now.T_odom_base, body_.turning_radius_m() + kDoubtfulM);
  }
}

/// Adds the boundary of the geofence. Must follow observe(), because the boundary moves when the
/// pose is corrected.
void Navigator::join_geofence(Situation& now) const {
  if (now.geofence == nullptr) {
    return;
  }
  // Far enough to stop before it from the fastest speed.
  const double reach_m = body_.turning_radius_m() + params_.local_map.range_m +
                         params_.robot.braking.required_distance_m(params_.drive.max_forward_mps,
                                                                   params_.drive.reaction_s);
  const geometry::SE2 T_map_base = now.T_map_odom * now.T_odom_base;
  const geometry::SE2 T_base_map = T_map_base.inverse();
  for (const auto& p_map : now.geofence->boundary_near(T_map_base.translation(), reach_m)) {
    now.points_base.push_back(T_base_map * p_map);
  }
}

Decision Navigator::brake(const Situation& now, Reason reason) const {
  Decision decision;
  decision.behaviour = Behaviour::kBrake;
  decision.reason = std::move(reason);
  decision.free_distance_m = brake_.measure_arc(0.0, now).free_distance_m;
  return decision;
}

Decision Navigator::wait(const Situation& now, Reason reason) const {
  Decision decision = brake(now, std::move(reason));
  decision.behaviour = turn_.is_active() ? Behaviour::kTurn : Behaviour::kBrake;
  return decision;
}

Decision Navigator::turn(const FreeSpace& space, const Situation& now) {
  const TurnCommand command = turn_.step(turn_input(space, now), preferred_side(now));
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
  decision.steering_angle_rad = turn_.side() * 0.5 * geometry::kPi;
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
    default:
      turn_.end();
      turn_ended_at_ = now.T_odom_base;
      decision.reason = Why::kFreeAhead;
  }
  return decision;
}

TurnInput Navigator::turn_input(const FreeSpace& space, const Situation& now) const {
  const double until_free_m = params_.turn.until_free_m;
  const FreeNeighbours seen =
      free_neighbours(steering_.seen_space(space, seen_, now), 0.0, until_free_m);
  const FreeNeighbours without_points = free_neighbours(space, 0.0, until_free_m);
  const double margin_m = params_.turn.margin_m + (turn_.backs_up() ? kRoomToTurnM : 0.0);
  TurnInput input;
  input.stamp = now.stamp;
  input.heading_rad = now.T_odom_base.yaw;
  input.yaw_rate_rad_s = now.yaw_rate_rad_s;
  input.clear_direction_rad = nearer_direction(seen);
  input.more_room_side = side_with_more_room(space);
  input.ahead_is_free =
      space.at(0) >= until_free_m && brake_.measure_arc(0.0, now).free_distance_m >= until_free_m;
  input.ahead_is_seen = steering_.is_seen(0.0, seen_, now);
  input.left = {free_rotation(now.points_base, 1.0, body_, margin_m),
                without_points.left_rad.value_or(kEndless)};
  input.right = {free_rotation(now.points_base, -1.0, body_, margin_m),
                 without_points.right_rad ? -*without_points.right_rad : kEndless};
  input.has_path_back = back_up_.has_path(now.T_odom_base);
  return input;
}

double Navigator::preferred_side(const Situation& now) {
  if (now.goal && steering_.detour().side() != 0.0) {
    return steering_.detour().side();
  }
  const bool is_same_obstacle =
      turn_ended_at_ && std::hypot(turn_ended_at_->x - now.T_odom_base.x,
                                   turn_ended_at_->y - now.T_odom_base.y) < kSameObstacleM;
  return is_same_obstacle ? turn_.side() : 0.0;
}

Decision Navigator::back_up(const Situation& now) {
  Decision decision = brake(now, Why::kBacksUpTrail);
  decision.behaviour = Behaviour::kTurn;
  if (!back_up_.step(now, decision)) {
    turn_.pause(now.stamp);
    decision.reason = Why::kNoWayBack;
  }
  return decision;
}

}  // namespace nodmap::navigator
