// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/brake.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {
namespace {

// Stop margin while creeping. At 0.25 m/s the robot is stationary after 5 cm. With the larger
// margin of a fast robot it would stop before each bend of a narrow place.
constexpr double kCreepStopMarginM = 0.05;
// An obstacle close ahead hides the floor behind it. To dock, the robot may creep towards it, so
// slowly that it is stationary after 1.5 cm, with 5 cm left.
constexpr double kHiddenMps = 0.1;
constexpr double kHiddenSeenM = 0.05;
// Margin beside places where beams passed through the floor, in addition to the side margin. A beam
// that ends 3 cm below the floor counts as floor at 1.2 m: to this beam the last 9 cm of a hole
// look like floor.
constexpr double kEdgeMarginM = 0.1;
// At this yaw rate the corners of KURT3D move at 5 cm/s: they do not push away what they touch.
constexpr double kCreepRadS = geometry::deg_to_rad(10.0);

}  // namespace

Arc Brake::measure_arc(double curvature, const Situation& now) const {
  return measure_arc(curvature, creeps_, now);
}

Arc Brake::measure_arc(double curvature, bool creeps, const Situation& now) const {
  Arc arc = measure_corridor(curvature, drive_params_.side_margin_m, braking_.stop_margin_m, now);
  if (creeps && arc.speed_mps < drive_params_.creep_mps) {
    Arc narrow = measure_corridor(curvature, drive_params_.creep_margin_m,
                                  std::min(kCreepStopMarginM, braking_.stop_margin_m), now);
    narrow.speed_mps = std::min(narrow.speed_mps, drive_params_.creep_mps);
    if (narrow.speed_mps > arc.speed_mps) {
      arc = narrow;
    }
  }
  if (now.needs_seen_floor()) {
    const double limit_mps = std::min(arc.speed_mps, drive_params_.max_forward_mps);
    arc.speed_mps = std::min(arc.speed_mps, speed_on_seen_floor(curvature, limit_mps, now));
  }
  arc.speed_mps = std::min(arc.speed_mps, speed_before_ramps_down(curvature, now));
  return arc;
}

Arc Brake::measure_corridor(double curvature, double side_margin_m, double stop_margin_m,
                            const Situation& now) const {
  const double distance_m =
      std::min(free_distance(now.points_base, curvature, body_, side_margin_m),
               free_distance(now.unseen_ahead_base, curvature, body_, side_margin_m));
  return {curvature, distance_m, stop_margin_m, stoppable_mps(distance_m - stop_margin_m)};
}

// A gap in the floor that was not looked at is bridged by speed_on_seen_floor(), also along the
// whole edge of the body. Where beams passed through the floor nothing is bridged: a narrow hole,
// or the corner of one, looks no lower from the distance of a stop than a ramp could be. A ramp is
// known as ground once the robot has slowed down before it and looked at it from nearer.
double Brake::speed_before_ramps_down(double curvature, const Situation& now) const {
  const double distance_m = free_distance(now.possible_ramps_down_base, curvature, body_,
                                          drive_params_.side_margin_m + kEdgeMarginM);
  return braking_.permitted_mps(distance_m, drive_params_.reaction_s);
}

// Why the robot never drives faster than it can stop on floor that was seen. Let F(g) be how far
// floor was seen with no gap longer than g. From a speed v it is stationary within
// d(v) = v T + v^2 / 2a. Both
//
//     v <= v(F(wide gap), a: braking)    and    v <= v(F(max gap), a: emergency braking)
//
// hold in every decision, for the arc chosen and for the arc it is on. F shrinks by no more than
// the robot drives, because what was seen stays seen. While the robot brakes with a, v(F) falls no
// faster than v (stopping.hpp). A hole as long as the wide gap has had a beam in it: the robot
// stops for it as for an obstacle. For a hole as long as the max gap it stops with the force that
// the base has in reserve. Over a shorter one that no beam has entered, with floor on both sides,
// the wheels roll.
double Brake::speed_on_seen_floor(double curvature, double max_mps, const Situation& now) const {
  struct Rule {
    double max_gap_m;
    double deceleration_mps2;
  };
  const SeenFloor floor = now.local_map->seen_floor();
  double speed_mps = max_mps;
  for (const Rule& rule : {Rule{local_map_params_.wide_gap_m, braking_.deceleration_mps2},
                           Rule{local_map_params_.max_gap_m, braking_.emergency_mps2(curvature)}}) {
    const double longest_m =
        robot::stopping_distance(speed_mps, drive_params_.reaction_s, rule.deceleration_mps2);
    const double seen_m = floor.distance(now.T_odom_base, curvature, longest_m, rule.max_gap_m);
    if (seen_m < longest_m) {
      speed_mps = robot::stoppable_speed(seen_m, drive_params_.reaction_s, rule.deceleration_mps2);
    }
  }
  constexpr bool kEndsAtObstacles = true;
  const double slow_mps = std::min(kHiddenMps, max_mps);
  const bool may_creep =
      creeps_ && speed_mps < slow_mps &&
      floor.distance(now.T_odom_base, curvature, kHiddenSeenM, local_map_params_.max_gap_m,
                     kEndsAtObstacles) >= kHiddenSeenM;
  return may_creep ? slow_mps : speed_mps;
}

double Brake::speed_on_present_arc(const Situation& now) const {
  const double forward_mps = now.forward_mps;
  if (forward_mps < kMinSpeedMps) {
    return std::numeric_limits<double>::infinity();
  }
  // A robot that has rotated and begins to drive is on a tight arc, on which 15 cm are 50 degrees.
  // If it had to keep them, it would stop again. Slowly it needs no more than a creeping one.
  const bool creeps = creeps_ || forward_mps < drive_params_.creep_mps;
  const Arc arc = measure_arc(now.yaw_rate_rad_s / forward_mps, creeps, now);
  const double emergency_mps = robot::stoppable_speed(arc.free_distance_m - arc.stop_margin_m, 0.0,
                                                      braking_.emergency_mps2(arc.curvature));
  return forward_mps > emergency_mps ? 0.0 : arc.speed_mps;
}

// Why that is safe: in each decision speed_on_present_arc() limits the speed on this arc, as for
// any arc that is driven, and is 0 where only an emergency stop suffices. As the curvature stays,
// yaw rate and lateral acceleration only decrease.
Decision Brake::slow_down(Reason reason, const Situation& now) const {
  Decision decision = stationary(std::move(reason));
  const double forward_mps = now.forward_mps;
  if (std::min(forward_mps, now.max_forward_mps) < kMinSpeedMps) {
    return decision;
  }
  // With commands that are slower than it is by what it loses until it has followed them, the base
  // brakes ordinarily.
  const double slower_mps = forward_mps - braking_.deceleration_mps2 * base_params_.response_s;
  decision.forward_mps =
      std::max(0.0, std::min({slower_mps, now.max_forward_mps, speed_on_present_arc(now)}));
  decision.yaw_rate_rad_s = decision.forward_mps * now.yaw_rate_rad_s / forward_mps;
  decision.max_forward_mps = decision.forward_mps;
  return decision;
}

Decision Brake::drive(const Arc& arc, double direction_rad, double limit_mps,
                      const Situation& now) const {
  const double goal_mps = now.goal ? stoppable_mps(now.goal->distance_m()) : limit_mps;
  const double safe_mps = std::min(arc.speed_mps, speed_on_present_arc(now));
  const bool is_slowed = safe_mps < limit_mps;
  Decision decision;
  decision.behaviour = is_slowed ? Behaviour::kBrake : Behaviour::kSteer;
  decision.reason = is_slowed ? Why::kSlowsDown : Why::kNothingToAdd;
  decision.forward_mps = std::min({limit_mps, goal_mps, safe_mps});
  decision.yaw_rate_rad_s = decision.forward_mps * arc.curvature;
  decision.steering_angle_rad = direction_rad;
  decision.free_distance_m = arc.free_distance_m;
  decision.max_forward_mps = std::min(limit_mps, safe_mps);
  return decision;
}

// The laser does not look where a rotation moves the rear. So doubtful ground counts there, which
// is what the local map remembers. Ahead speed_on_seen_floor() takes care of that, behind the robot
// its trail (back_up.hpp).
void Brake::keep_to_known_ground(Decision& decision, const Situation& now) const {
  const double yaw_rate_rad_s = std::abs(decision.yaw_rate_rad_s);
  if (yaw_rate_rad_s <= kCreepRadS || decision.forward_mps < 0.0 || now.doubtful_base.empty()) {
    return;
  }
  // A cell's centre stands for the whole cell: the body keeps half a cell away.
  const robot::Footprint inner =
      body_.grown(-0.5 * local_map_params_.cell_size_m, -0.5 * local_map_params_.cell_size_m);
  double allowed_rad_s = 0.0;
  if (decision.forward_mps == 0.0) {
    const Side side = side_of(decision.yaw_rate_rad_s);
    allowed_rad_s = stoppable_rad_s(free_rotation(now.doubtful_base, side, inner, 0.0));
  } else {
    const double curvature = decision.yaw_rate_rad_s / decision.forward_mps;
    Points beside = now.doubtful_base;
    std::erase_if(beside, [&](const Eigen::Vector2d& p) { return p.x() > body_.half_length_m; });
    allowed_rad_s =
        std::abs(curvature) * stoppable_mps(free_distance(beside, curvature, inner, 0.0));
  }
  const double factor = std::min(1.0, std::max(kCreepRadS, allowed_rad_s) / yaw_rate_rad_s);
  decision.forward_mps *= factor;
  decision.yaw_rate_rad_s *= factor;
  decision.max_forward_mps *= factor;
}

// As for obstacles (speed_on_present_arc), the ordinary brakes decide how fast the robot may drive,
// and all of their force when it must stop at once. That is safe because the base brakes towards a
// slower command with all of its force, too: between the two it brakes no less than for a stop, and
// the stop is commanded a reaction time before even an emergency stop would be too late. If one
// border served for both, a robot that drives at it would stop for each error of a track.
void Brake::give_way(Decision& decision, const Situation& now) const {
  const Twist present{now.forward_mps, now.yaw_rate_rad_s};
  const Twist commanded{decision.forward_mps, decision.yaw_rate_rad_s};
  const bool is_late = !passive_safety_.can_stop(present, now.people);
  const double factor = is_late ? 0.0 : passive_safety_.safe_factor(commanded, now.people);
  if (factor == 1.0 || passive_safety_.escapes(present, commanded, now.people)) {
    return;
  }
  decision.behaviour =
      decision.behaviour == Behaviour::kSteer ? Behaviour::kBrake : decision.behaviour;
  decision.reason = Why::kGivesWay;
  decision.forward_mps *= factor;
  decision.yaw_rate_rad_s *= factor;
  decision.max_forward_mps =
      std::min(decision.max_forward_mps, std::max(0.0, decision.forward_mps));
}

double Brake::speed_limit(double curvature, double max_forward_mps) const {
  const double bend = std::abs(curvature);
  double speed_mps = std::max(0.0, std::min(max_forward_mps, drive_params_.max_forward_mps));
  if (bend > 0.0) {
    speed_mps = std::min({speed_mps, drive_params_.max_yaw_rate_rad_s / bend,
                          std::sqrt(drive_params_.max_lateral_mps2 / bend)});
  }
  return speed_mps;
}

double Brake::stoppable_mps(double distance_m) const {
  return robot::stoppable_speed(distance_m, drive_params_.reaction_s, braking_.deceleration_mps2);
}

double Brake::stopping_m(double forward_mps) const {
  return robot::stopping_distance(forward_mps, drive_params_.reaction_s,
                                  braking_.deceleration_mps2);
}

double Brake::stoppable_rad_s(double angle_rad) const {
  return rate_to_stop_within_rad_s(angle_rad, turn_params_, base_params_, drive_params_.reaction_s);
}

double rate_to_stop_within_rad_s(double angle_rad, const TurnParams& turn, const BaseParams& base,
                                 double reaction_s) {
  return std::min(turn.rate_rad_s,
                  robot::stoppable_speed(angle_rad, reaction_s, base.rotation_deceleration_rad_s2));
}

}  // namespace nodmap::navigator
