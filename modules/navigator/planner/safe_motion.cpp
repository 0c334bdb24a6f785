// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/safe_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/navigator/trail.hpp"
#include "modules/navigator/turn.hpp"

namespace nodmap::navigator {
namespace {

// The direction of an arc is that of its point at this length.
constexpr double kLookM = 0.5;
// The number of forward rollouts, the best ones, that are offered to Brake.
constexpr std::size_t kMostOffered = 40;
// Margin behind the robot, where it knows only what it remembers.
constexpr double kBackwardMarginM = 0.03;
constexpr double kRotationMarginM = 0.02;
constexpr double kLeastRotationRad = geometry::deg_to_rad(2.0);

// Direction of a forward rollout, in base.
double direction_rad(const Rollout& rollout) {
  return std::clamp(0.5 * kLookM * rollout.yaw_rate_rad_s / rollout.forward_mps, -1.2, 1.2);
}

}  // namespace

SafeMotion::SafeMotion(const NavigatorParams& params)
    : body_(params.robot.body.footprint()),
      turn_params_(params.turn),
      reaction_s_(params.drive.reaction_s) {}

// The best rollout after Brake has slowed it down: the loss of speed counts as cost.
std::optional<Decision> SafeMotion::best_of(const std::vector<Rollout>& rollouts,
                                            const Brake& brake, const Situation& now) const {
  std::optional<Decision> best;
  double least_cost_m = std::numeric_limits<double>::infinity();
  std::size_t num_offered = 0;
  for (const Rollout& rollout : rollouts) {
    if (rollout.cost_m >= least_cost_m) {
      break;
    }
    // Rotations and driving backwards are cheap to check.
    if (rollout.forward_mps > 0.0 && ++num_offered > kMostOffered) {
      continue;
    }
    const auto driven = drive(rollout, brake, now);
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

// A rollout as Brake allows it; empty where it does not.
std::optional<Decision> SafeMotion::drive(const Rollout& rollout, const Brake& brake,
                                          const Situation& now) const {
  if (rollout.forward_mps == 0.0 && rollout.yaw_rate_rad_s == 0.0) {
    return stationary(Why::kGivesWay);
  }
  std::optional<Decision> decision = move(rollout, brake, now);
  if (decision) {
    brake.keep_to_known_ground(*decision, now);
    brake.give_way(*decision, now);
    if (decision->forward_mps == 0.0 && decision->yaw_rate_rad_s == 0.0) {
      return std::nullopt;
    }
  }
  return decision;
}

std::optional<Decision> SafeMotion::move(const Rollout& rollout, const Brake& brake,
                                         const Situation& now) const {
  if (rollout.forward_mps > 0.0) {
    return drive_forwards(rollout, brake, now);
  }
  if (rollout.forward_mps < 0.0) {
    return drive_backwards(rollout, brake, now);
  }
  return rotate(rollout, now);
}

std::optional<Decision> SafeMotion::drive_forwards(const Rollout& rollout, const Brake& brake,
                                                   const Situation& now) const {
  const double curvature = rollout.yaw_rate_rad_s / rollout.forward_mps;
  if (!now.has_seen(direction_rad(rollout))) {
    return std::nullopt;
  }
  const Arc arc = brake.measure_arc(curvature, now);
  if (arc.speed_mps < kLeastSpeedMps) {
    return std::nullopt;
  }
  const double limit_mps =
      std::min(brake.speed_limit(curvature, now.max_forward_mps), rollout.forward_mps);
  Decision decision = brake.drive(arc, direction_rad(rollout), limit_mps, now);
  // An emergency stop applies to all rollouts, so it is no reason to prefer another one.
  decision.max_forward_mps = std::min(limit_mps, arc.speed_mps);
  return decision;
}

// Slowly, only over floor that was seen, and on the strip that the body has driven: the laser does
// not look there.
std::optional<Decision> SafeMotion::drive_backwards(const Rollout& rollout, const Brake& brake,
                                                    const Situation& now) const {
  if (now.trail == nullptr) {
    return std::nullopt;
  }
  const double curvature = rollout.yaw_rate_rad_s / rollout.forward_mps;
  double distance_m = free_distance_backwards(now.points_base, curvature, body_, kBackwardMarginM) -
                      kBackwardMarginM;
  distance_m = std::min(distance_m, now.trail->distance_backwards(now.T_odom_base, curvature));
  if (now.needs_seen_floor) {
    distance_m = std::min(distance_m, now.local_map->seen_distance_backwards(
                                          now.T_odom_base, curvature, body_.half_width_m, 0.3));
  }
  const double speed_mps = std::min(-rollout.forward_mps, brake.stoppable_mps(distance_m));
  if (speed_mps < 0.5 * kLeastSpeedMps || now.forward_mps > kLeastSpeedMps) {
    return std::nullopt;
  }
  Decision decision;
  decision.behaviour = Behaviour::kTurn;
  decision.reason = Why::kBacksUp;
  decision.forward_mps = -speed_mps;
  decision.yaw_rate_rad_s = -speed_mps * curvature;
  return decision;
}

std::optional<Decision> SafeMotion::rotate(const Rollout& rollout, const Situation& now) const {
  const Side side = side_of(rollout.yaw_rate_rad_s);
  const double free_rad = free_rotation(now.points_base, side, body_, kRotationMarginM);
  if (free_rad < kLeastRotationRad) {
    return std::nullopt;
  }
  Decision decision;
  decision.behaviour = Behaviour::kTurn;
  decision.reason = Why::kTurnsToPath;
  decision.yaw_rate_rad_s =
      sign(side) * std::min(std::abs(rollout.yaw_rate_rad_s),
                            yaw_rate_on_the_spot(free_rad, turn_params_, reaction_s_));
  decision.steering_angle_rad = sign(side) * 0.5 * geometry::kPi;
  return decision;
}

}  // namespace nodmap::navigator
