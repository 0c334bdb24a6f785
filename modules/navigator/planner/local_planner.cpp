// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/local_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/trail.hpp"

namespace nodmap::navigator {
namespace {

// Places of an arc are this far apart where it is examined whether the laser has looked there.
constexpr double kLookStepM = 0.05;
// A place farther aside than this comes into view when the robot has turned.
constexpr double kFarthestAsideRad = 1.2;
// The direction that is shown for an arc is that of its place at this length.
constexpr double kShownM = 0.5;
// The number of forward rollouts, the best ones, that are offered to Brake.
constexpr std::size_t kMaxOffered = 40;
// Margin behind the robot, where it knows only what it remembers.
constexpr double kBackwardMarginM = 0.03;
// Seen floor is looked for this far behind the body: more than any stop from driving backwards
// takes.
constexpr double kBackwardSeenM = 0.3;
constexpr double kRotationMarginM = 0.02;
constexpr double kMinRotationRad = geometry::deg_to_rad(2.0);

// Direction of an arc's place at a length, in base: that of the chord.
double direction_rad(double curvature, double length_m) {
  return std::clamp(0.5 * length_m * curvature, -kFarthestAsideRad, kFarthestAsideRad);
}

bool is_stop(const Decision& decision) {
  return decision.forward_mps == 0.0 && decision.yaw_rate_rad_s == 0.0;
}

}  // namespace

LocalPlanner::LocalPlanner(const NavigatorParams& params, bool creeps)
    : body_(params.robot.body.footprint()), brake_(params, creeps), rollouts_(params) {}

std::optional<Decision> LocalPlanner::drive_best(const Situation& now, const CostToGo& cost_to_go) {
  const double max_forward_mps = brake_.speed_limit(0.0, now.max_forward_mps);
  const std::vector<Rollout>& rollouts = rollouts_.plan(now, cost_to_go, max_forward_mps);
  auto best = drive_best_of(rollouts, now);
  if (!best) {
    why_stays_ = reason_to_stay(rollouts, now);
  }
  return best;
}

// What keeps the robot from all rollouts, none of which touches anything: that the laser has not
// looked where one leads, somebody, or that they lead back where it has not driven.
Why LocalPlanner::reason_to_stay(std::span<const Rollout> rollouts, const Situation& now) const {
  const auto waits_for_laser = [&](const Rollout& rollout) {
    return rollout.forward_mps > 0.0 &&
           speed_where_looked(rollout.yaw_rate_rad_s / rollout.forward_mps, kMinSpeedMps, now) <
               kMinSpeedMps;
  };
  if (std::ranges::any_of(rollouts, waits_for_laser)) {
    return Why::kFirstLook;
  }
  if (!rollouts.empty() && !now.people.empty()) {
    return Why::kGivesWay;
  }
  const bool leads_back = std::ranges::any_of(
      rollouts, [](const Rollout& rollout) { return rollout.forward_mps < 0.0; });
  return leads_back ? Why::kNoWayBack : Why::kNoMotion;
}

// The best rollout after Brake has slowed it down: the loss of speed counts as cost.
std::optional<Decision> LocalPlanner::drive_best_of(std::span<const Rollout> rollouts,
                                                    const Situation& now) const {
  std::optional<Decision> best;
  double least_cost_m = std::numeric_limits<double>::infinity();
  std::size_t num_offered = 0;
  for (const Rollout& rollout : rollouts) {
    if (rollout.cost_m >= least_cost_m) {
      break;
    }
    // Rotations and driving backwards are cheap to check.
    if (rollout.forward_mps > 0.0 && ++num_offered > kMaxOffered) {
      continue;
    }
    const auto driven = drive({rollout.forward_mps, rollout.yaw_rate_rad_s}, now);
    if (!driven) {
      continue;
    }
    const double slower_mps = std::max(0.0, rollout.forward_mps - driven->max_forward_mps);
    const double cost_m = rollout.cost_m + Rollouts::kDurationS * slower_mps;
    if (cost_m < least_cost_m) {
      least_cost_m = cost_m;
      best = driven;
    }
  }
  return best;
}

std::optional<Decision> LocalPlanner::drive(const Twist& motion, const Situation& now) const {
  if (motion.forward_mps == 0.0 && motion.yaw_rate_rad_s == 0.0) {
    return stationary(Why::kGivesWay);
  }
  std::optional<Decision> decision = move(motion, now);
  if (!decision) {
    return std::nullopt;
  }
  // To rotate, a robot that drives may have to stop first. It is the rotation that it then drives.
  const bool stops_to_rotate = motion.forward_mps == 0.0 && is_stop(*decision);
  brake_.keep_to_known_ground(*decision, now);
  brake_.give_way(*decision, now);
  return is_stop(*decision) && !stops_to_rotate ? std::nullopt : decision;
}

std::optional<Decision> LocalPlanner::move(const Twist& motion, const Situation& now) const {
  if (motion.forward_mps > 0.0) {
    return drive_forwards(motion, now);
  }
  if (motion.forward_mps < 0.0) {
    return drive_backwards(motion, now);
  }
  return rotate(motion.yaw_rate_rad_s, now);
}

std::optional<Decision> LocalPlanner::drive_forwards(const Twist& motion,
                                                     const Situation& now) const {
  const double curvature = motion.yaw_rate_rad_s / motion.forward_mps;
  const double limit_mps =
      std::min(brake_.speed_limit(curvature, now.max_forward_mps), motion.forward_mps);
  const double seen_mps = speed_where_looked(curvature, std::max(limit_mps, kMinSpeedMps), now);
  if (seen_mps < kMinSpeedMps) {
    return std::nullopt;
  }
  Arc arc = brake_.measure_arc(curvature, now);
  arc.speed_mps = std::min(arc.speed_mps, seen_mps);
  if (arc.speed_mps < kMinSpeedMps) {
    return std::nullopt;
  }
  Decision decision = brake_.drive(arc, direction_rad(curvature, kShownM), limit_mps, now);
  // An emergency stop applies to all rollouts, so it is no reason to prefer another one.
  decision.max_forward_mps = std::min(limit_mps, arc.speed_mps);
  return decision;
}

// The speed, at most `limit_mps`, from which the front stops before the first place of an arc in
// whose direction the laser has not looked yet. So the robot is always stationary before it, as for
// floor that was not seen (Brake::speed_on_seen_floor()); here also for what is above the floor.
// The border lies less than a step before that place, so a step is kept.
double LocalPlanner::speed_where_looked(double curvature, double limit_mps,
                                        const Situation& now) const {
  const double front_m = body_.half_length_m + kLookStepM;
  const double longest_m = front_m + brake_.stopping_m(limit_mps);
  for (double length_m = kLookStepM; length_m < longest_m; length_m += kLookStepM) {
    if (!now.has_seen(direction_rad(curvature, length_m))) {
      return std::min(limit_mps, brake_.stoppable_mps(length_m - front_m));
    }
  }
  return limit_mps;
}

// Slowly, only over floor that was seen, and on the strip that the body has driven: the laser does
// not look there.
std::optional<Decision> LocalPlanner::drive_backwards(const Twist& motion,
                                                      const Situation& now) const {
  if (now.trail == nullptr) {
    return std::nullopt;
  }
  const double curvature = motion.yaw_rate_rad_s / motion.forward_mps;
  double distance_m = free_distance_backwards(now.points_base, curvature, body_, kBackwardMarginM) -
                      kBackwardMarginM;
  distance_m = std::min(distance_m, now.trail->distance_backwards(now.T_odom_base, curvature));
  if (now.needs_seen_floor()) {
    distance_m = std::min(distance_m, now.local_map->seen_floor().distance_backwards(
                                          now.T_odom_base, curvature, kBackwardSeenM));
  }
  const double speed_mps = std::min(-motion.forward_mps, brake_.stoppable_mps(distance_m));
  if (speed_mps < 0.5 * kMinSpeedMps || now.forward_mps > kMinSpeedMps) {
    return std::nullopt;
  }
  return backing(speed_mps, curvature, Why::kBacksUp);
}

std::optional<Decision> LocalPlanner::rotate(double yaw_rate_rad_s, const Situation& now) const {
  const Side side = side_of(yaw_rate_rad_s);
  const double free_rad = free_rotation(now.points_base, side, body_, kRotationMarginM);
  if (free_rad < kMinRotationRad) {
    return std::nullopt;
  }
  // While the body moves on, free_rotation() is true of a place that it leaves.
  Decision decision = brake_.slow_down(Why::kTurnsToPath, now);
  decision.behaviour = Behaviour::kTurn;
  if (now.forward_mps < kMinSpeedMps) {
    decision.yaw_rate_rad_s =
        sign(side) * std::min(std::abs(yaw_rate_rad_s), brake_.stoppable_rad_s(free_rad));
  }
  decision.steering_angle_rad = sign(side) * 0.5 * geometry::kPi;
  return decision;
}

}  // namespace nodmap::navigator
