// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/rollouts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/angle.hpp"
#include "modules/navigator/behaviours/brake.hpp"
#include "modules/navigator/behaviours/corridor.hpp"
#include "modules/navigator/people/foresight.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kStepS = 0.1;
const int kSteps = static_cast<int>(std::lround(Rollouts::kDurationS / kStepS));
constexpr int kFirstSteps = 8;
// People count for 3 s, so somebody who approaches at 1 m/s counts from 3 m away.
constexpr int kForeseenSteps = 30;
// Resolution of the base's speed command.
constexpr double kStepMps = 0.01;
// The heading at the end is rated by the plan's cost this far ahead of the robot.
constexpr double kAheadM = 0.3;
constexpr double kAheadWeight = 0.6;
// Without a path from that point, its cost is that of the robot's place plus this.
constexpr double kBlockedAheadM = 0.6;
// Cost of a second until the goal is reached. If all rollouts that reach it cost the same, the
// robot would put off its arrival in every decision, and drive in circles round a goal beside it.
// For the length of a rollout this is less than the cost of any that does not reach the goal.
constexpr double kUntilArrivalMPerS = 0.1;
// A rotation on the spot can go on to a better heading, at this cost for each radian.
constexpr double kFurtherMPerRad = 0.2;
constexpr double kFurtherStepRad = geometry::deg_to_rad(15.0);
// Additional cost of a place beside all paths, but near one.
constexpr double kOffPathM = 0.5;
// A rotation of 1 rad moves the corners by about this.
constexpr double kCornerM = 0.25;
// Change of the clearance from one moment to the next by the noise of points and cells.
constexpr double kNoiseM = 0.01;
// Least clearance on the spot and backwards. The robot is slow there, and its free rotation is
// also measured exactly. A corridor of 0.7 m leaves 7 cm at the corners of a rotating body.
constexpr double kSlowClearanceM = 0.025;
// A robot that can rotate by less than this to both sides cannot turn: driving backwards then
// costs less than the 0.4 m that it gains in 1.6 s.
constexpr double kTurnRad = geometry::deg_to_rad(60.0);
constexpr double kCannotTurnReversePriceM = 0.2;

// The speeds tried, as fractions of the fastest speed, and of the creeping speed: in a narrow
// place none of the former may be slow enough.
constexpr std::array kSpeeds{1.0, 0.8, 0.6, 0.42, 0.27, 0.15};
constexpr std::array kCreepSpeeds{1.0, 0.5};
constexpr std::array kYawRates{-1.0, -0.75, -0.55, -0.38, -0.24, -0.13, -0.05, 0.0,
                               0.05, 0.13,  0.24,  0.38,  0.55,  0.75,  1.0};
// Slowest rotation on the spot, as a fraction of the fastest.
constexpr double kSlowestRotation = 0.2;
constexpr std::array kNextYawRates{-0.8, -0.4, -0.15, 0.0, 0.15, 0.4, 0.8};
constexpr std::array kBackwardMps{-0.08, -0.15};

// The motion a step later. A robot that is to rotate slows down on its arc first.
Twist towards(const Twist& motion, const Twist& now, const BaseParams& base) {
  const Twist next = after(now, motion, kStepS, base);
  const bool slows_down =
      motion.forward_mps == 0.0 && motion.yaw_rate_rad_s != 0.0 && now.forward_mps >= kMinSpeedMps;
  return slows_down ? now.scaled(next.forward_mps / now.forward_mps) : next;
}

// The plan's cost of a motion's end, place and heading.
double end_cost(const geometry::SE2& T_map_end, const CostToGo& cost_to_go) {
  double here = cost_to_go.at(T_map_end.translation());
  if (!std::isfinite(here)) {
    here = kOffPathM + cost_to_go.least_near(T_map_end.translation());
  }
  const double ahead = cost_to_go.at(T_map_end * Eigen::Vector2d(kAheadM, 0.0));
  return here + kAheadWeight * std::min(ahead, here + kBlockedAheadM);
}

}  // namespace

Rollouts::Rollouts(const NavigatorParams& params)
    : body_(params.robot.body.footprint()),
      params_(params.planner),
      drive_params_(params.drive),
      base_params_(params.base),
      people_params_(params.people),
      clearance_(body_) {}

const std::vector<Rollout>& Rollouts::plan(const Situation& now, const CostToGo& cost_to_go,
                                           double max_forward_mps) {
  clearance_.measure(now.points_base);
  // A robot that is nearer already may drive on, but must not come nearer.
  const double clearance_now_m = clearance_.at({}) - kNoiseM;
  least_clearance_m_ = std::min(params_.min_clearance_m, clearance_now_m);
  least_creeping_clearance_m_ = std::min(least_clearance_m_, drive_params_.creep_margin_m);
  least_slow_clearance_m_ = std::min(least_clearance_m_, kSlowClearanceM);
  free_left_rad_ = free_rotation(now.points_base, Side::kLeft, body_, kSlowClearanceM);
  free_right_rad_ = free_rotation(now.points_base, Side::kRight, body_, kSlowClearanceM);
  const double free_rad = std::max(free_left_rad_, free_right_rad_);
  reverse_price_m_ = free_rad < kTurnRad ? std::min(params_.reverse_price, kCannotTurnReversePriceM)
                                         : params_.reverse_price;
  rollouts_.clear();
  for (const double share : kSpeeds) {
    consider_forwards(share * max_forward_mps, now, cost_to_go);
  }
  for (const double share : kCreepSpeeds) {
    consider_forwards(share * std::min(max_forward_mps, drive_params_.creep_mps), now, cost_to_go);
  }
  for (const double yaw_rate : kYawRates) {
    const double yaw_rate_rad_s = yaw_rate * params_.rotation_rad_s;
    if (std::abs(yaw_rate) >= kSlowestRotation) {
      consider({0.0, yaw_rate_rad_s}, now, cost_to_go);
    }
    for (const double speed_mps : kBackwardMps) {
      consider({speed_mps, yaw_rate_rad_s}, now, cost_to_go);
    }
  }
  if (!now.people.empty()) {
    consider({}, now, cost_to_go);
  }
  std::ranges::sort(rollouts_, {}, &Rollout::cost_m);
  return rollouts_;
}

// Motions with the same first half share its rollout. A speed of 0 is none of them: squeezing and
// creeping can be switched off so.
void Rollouts::consider_forwards(double forward_mps, const Situation& now,
                                 const CostToGo& cost_to_go) {
  if (forward_mps <= 0.0) {
    return;
  }
  for (const double yaw_rate : kYawRates) {
    const Twist motion{forward_mps, yaw_rate * drive_params_.max_yaw_rate_rad_s};
    if (motion.forward_mps * std::abs(motion.yaw_rate_rad_s) > drive_params_.max_lateral_mps2) {
      continue;
    }
    Progress half = start(now);
    if (!advance(half, motion, kFirstSteps, now)) {
      continue;
    }
    for (const double next : kNextYawRates) {
      const double next_yaw_rate_rad_s = next * drive_params_.max_yaw_rate_rad_s;
      Progress end = half;
      if (advance(end, {forward_mps, next_yaw_rate_rad_s}, kSteps, now)) {
        add(motion, next_yaw_rate_rad_s, end, now, cost_to_go);
      }
    }
  }
}

void Rollouts::consider(const Twist& motion, const Situation& now, const CostToGo& cost_to_go) {
  Progress end = start(now);
  if (advance(end, motion, kSteps, now)) {
    add(motion, motion.yaw_rate_rad_s, end, now, cost_to_go);
  }
}

Rollouts::Progress Rollouts::start(const Situation& now) {
  Progress progress;
  progress.twist = {now.forward_mps, now.yaw_rate_rad_s};
  return progress;
}

// Returns false if the body touches something.
bool Rollouts::advance(Progress& progress, const Twist& motion, int until_step,
                       const Situation& now) const {
  geometry::SE2& pose = progress.pose_base;
  while (progress.steps < until_step && !progress.has_arrived) {
    progress.twist = towards(motion, progress.twist, base_params_);
    const auto [v, w] = progress.twist;
    const double middle_yaw_rad = pose.yaw + 0.5 * kStepS * w;
    pose = {pose.x + kStepS * v * std::cos(middle_yaw_rad),
            pose.y + kStepS * v * std::sin(middle_yaw_rad), pose.yaw + kStepS * w};
    const double clearance = clearance_.at(pose);
    if (clearance < least_clearance_m(motion, v)) {
      return false;
    }
    ++progress.steps;
    const double ample_m =
        params_.ample_clearance_m + params_.ample_clearance_m_per_mps * std::abs(v);
    const double near = std::max(0.0, 1.0 - clearance / ample_m);
    progress.nearness_m += kStepS * std::hypot(v, kCornerM * w) * near * near;
    meet_people(progress, now.people);
    progress.has_arrived =
        now.goal && (now.goal->p_base - pose.translation()).norm() <= now.goal->tolerance_m;
  }
  return true;
}

// Once somebody touches the robot, all the rest of the rollout is an obstruction.
void Rollouts::meet_people(Progress& progress, const People& people) const {
  const double time_s = kStepS * progress.steps;
  progress.is_touched =
      progress.is_touched || std::ranges::any_of(people, [&](const Person& person) {
        return is_touched(body_, progress.pose_base, person, time_s, people_params_.margin_m);
      });
  progress.obstruction_s +=
      kStepS * (progress.is_touched ? 1.0 : obstruction(progress.pose_base, time_s, people));
}

// The obstruction after the rollout: the lesser of driving on and of stopping.
double Rollouts::foreseen_obstruction_s(const Progress& end, const People& people) const {
  if (people.empty()) {
    return 0.0;
  }
  return std::min(foresee(end, false, people), foresee(end, true, people));
}

double Rollouts::foresee(Progress progress, bool stops, const People& people) const {
  while (progress.steps < kForeseenSteps) {
    progress.twist = stops ? after(progress.twist, {}, kStepS, base_params_) : progress.twist;
    const auto [v, w] = progress.twist;
    progress.pose_base = progress.pose_base * geometry::SE2{kStepS * v, 0.0, kStepS * w};
    ++progress.steps;
    meet_people(progress, people);
  }
  return progress.obstruction_s;
}

void Rollouts::add(const Twist& first, double next_yaw_rate_rad_s, const Progress& end,
                   const Situation& now, const CostToGo& cost_to_go) {
  Rollout rollout{first.forward_mps, first.yaw_rate_rad_s, next_yaw_rate_rad_s, 0.0};
  const geometry::SE2 T_map_end = now.T_map_base() * end.pose_base;
  const bool is_rotation = first.forward_mps == 0.0 && first.yaw_rate_rad_s != 0.0;
  const double yaw_rad = end.pose_base.yaw;
  const double end_m =
      is_rotation ? rotation_cost(T_map_end, side_of(first.yaw_rate_rad_s), yaw_rad, cost_to_go)
                  : end_cost(T_map_end, cost_to_go);
  rollout.cost_m =
      (end.has_arrived ? kUntilArrivalMPerS * kStepS * end.steps : end_m) +
      params_.clearance_weight * end.nearness_m +
      people_params_.obstruction_cost_m_per_s * foreseen_obstruction_s(end, now.people) +
      params_.smoothness_weight * (std::abs(first.yaw_rate_rad_s - now.yaw_rate_rad_s) +
                                   std::abs(first.forward_mps - now.forward_mps)) +
      (first.forward_mps < 0.0 ? reverse_price_m_ : 0.0);
  if (std::isfinite(rollout.cost_m)) {
    rollouts_.push_back(rollout);
  }
}

// The plan's cost of a rotation on the spot that has come to `T_map_end`, by `yaw_rad`, and goes on
// to this side, to the best heading that is free. A path that leads back begins beyond what a
// rollout can rotate, and all headings before it cost the same: without looking further the robot
// would not turn round, but rotate a little to and fro.
double Rollouts::rotation_cost(const geometry::SE2& T_map_end, Side side, double yaw_rad,
                               const CostToGo& cost_to_go) const {
  const double free_rad = side == Side::kLeft ? free_left_rad_ : free_right_rad_;
  const double most_rad = std::min(geometry::kPi, free_rad) - std::abs(yaw_rad);
  double cost_m = end_cost(T_map_end, cost_to_go);
  for (double rad = kFurtherStepRad; rad <= most_rad; rad += kFurtherStepRad) {
    const geometry::SE2 T_map_further = T_map_end * geometry::SE2{0.0, 0.0, sign(side) * rad};
    cost_m = std::min(cost_m, end_cost(T_map_further, cost_to_go) + kFurtherMPerRad * rad);
  }
  return cost_m;
}

// The least clearance of a motion that has reached `forward_mps`.
double Rollouts::least_clearance_m(const Twist& motion, double forward_mps) const {
  if (motion.forward_mps <= 0.0) {
    return least_slow_clearance_m_;
  }
  return forward_mps > drive_params_.creep_mps + kStepMps ? least_clearance_m_
                                                          : least_creeping_clearance_m_;
}

double Rollouts::obstruction(const geometry::SE2& pose_base, double time_s,
                             const People& people) const {
  double most = 0.0;
  for (const Person& person : people) {
    const double distance_m =
        distance_to_path(pose_base.translation(), person, time_s, people_params_.ahead_s) -
        person.radius_m - body_.half_width_m;
    const double near = std::clamp(1.0 - distance_m / people_params_.comfort_m, 0.0, 1.0);
    most = std::max(most, near * near);
  }
  return most;
}

}  // namespace nodmap::navigator
