// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/docking.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/se2.hpp"
#include "modules/navigator/planner/patience.hpp"

namespace nodmap::navigator {
namespace {

using geometry::deg_to_rad;

// With a heading error below this the robot begins to follow the line.
constexpr double kAlignedRad = deg_to_rad(5.0);
// Greatest angle at which it drives back to the line.
constexpr double kSteepestRad = deg_to_rad(30.0);
constexpr double kMaxCurvature = 2.5;  // 1/m: the body's rear hardly swings aside
// Speed for each metre that is left, and the least speed: five steps of the base's speed command.
constexpr double kSpeedPerMetre = 0.8;
constexpr double kMinMps = 0.05;
// It still rolls this far at the least speed: half a reaction time after the command to stop.
constexpr double kRollsM = 0.003;
// It stops rotating when the heading error is below this fraction of the tolerance.
constexpr double kSquareRatio = 0.4;
constexpr double kYawRatePerRad = 1.2;
constexpr double kMinYawRate = deg_to_rad(3.0);
constexpr double kMaxYawRate = deg_to_rad(25.0);
constexpr double kBackOffMps = 0.1;
// A phase after the staging place takes less than this, unless somebody is in the way.
constexpr double kPatienceS = 25.0;
// After a failure it waits this long.
constexpr double kTryAgainS = 60.0;
// A docked robot leaves the goal only if its heading is off by more than the tolerance and this:
// more than noise.
constexpr double kLeaveRad = deg_to_rad(10.0);

geometry::SE2 T_goal_base(const GoalInBase& goal) {
  return geometry::SE2{goal.p_base.x(), goal.p_base.y(), goal.heading->yaw_rad}.inverse();
}

}  // namespace

DockingStep Docking::next(const GoalInBase& goal, time::Timestamp stamp) {
  const time::Duration period = stamp - decided_at_;
  if (std::chrono::abs(period) > kLongestPeriod) {
    phase_began_ += period;
  }
  decided_at_ = stamp;
  const double phase_s = time::seconds(std::chrono::abs(stamp - phase_began_));
  if (phase_ == Phase::kFailed && phase_s > kTryAgainS) {
    reset();
    decided_at_ = phase_began_ = stamp;
  }
  Phase phase = phase_;
  if (is_done(goal, phase_s)) {
    phase = next_phase(goal);
  } else if (phase_s > kPatienceS) {
    phase = phase_when_late();
  }
  if (phase != phase_) {
    enter(phase, stamp);
  }
  return step(goal);
}

void Docking::enter(Phase phase, time::Timestamp stamp) {
  const bool is_correction = phase_ == Phase::kSettle && phase != Phase::kDocked;
  num_tries_ += phase == Phase::kAlign || is_correction ? 1 : 0;
  phase_ = num_tries_ > params_.tries ? Phase::kFailed : phase;
  phase_began_ = stamp;
  if (phase_ == Phase::kDocked) {
    num_tries_ = 0;
  }
}

// Whether the present phase has done its part.
bool Docking::is_done(const GoalInBase& goal, double phase_s) const {
  const geometry::SE2 T = T_goal_base(goal);
  switch (phase_) {
    case Phase::kStage:
      return std::hypot(T.x + params_.staging_m, T.y) <= kStagingToleranceM;
    case Phase::kAlign:
      return std::abs(T.yaw) <= kAlignedRad;
    case Phase::kFollowLine:
      return -T.x <= kRollsM;
    case Phase::kSquare:
      return std::abs(T.yaw) <= kSquareRatio * goal.heading->tolerance_rad;
    case Phase::kSettle:
      return phase_s >= params_.settle_s;
    case Phase::kBackOff:
      return T.x <= -0.6 * params_.staging_m;
    case Phase::kDocked:
      return !has_arrived(goal, true) || std::abs(T.yaw) > goal.heading->tolerance_rad + kLeaveRad;
    case Phase::kFailed:
      break;
  }
  return false;
}

// The phase after the present one, when that is done.
Docking::Phase Docking::next_phase(const GoalInBase& goal) const {
  switch (phase_) {
    case Phase::kStage:
    case Phase::kBackOff:
      return Phase::kAlign;
    case Phase::kAlign:
      return Phase::kFollowLine;
    case Phase::kFollowLine:
      return Phase::kSquare;
    case Phase::kSquare:
      return Phase::kSettle;
    case Phase::kSettle:
      return after_settling(goal);
    case Phase::kDocked:
      return Phase::kStage;
    case Phase::kFailed:
      break;
  }
  return phase_;
}

// The phase after one that takes too long: after the last rotation the pose is checked as it is,
// any other motion starts over.
Docking::Phase Docking::phase_when_late() const {
  switch (phase_) {
    case Phase::kAlign:
    case Phase::kFollowLine:
    case Phase::kBackOff:
      return Phase::kStage;
    case Phase::kSquare:
      return Phase::kSettle;
    case Phase::kStage:
    case Phase::kSettle:
    case Phase::kDocked:
    case Phase::kFailed:
      break;
  }
  return phase_;
}

Docking::Phase Docking::after_settling(const GoalInBase& goal) {
  const geometry::SE2 T = T_goal_base(goal);
  if (has_arrived(goal, false)) {
    return std::abs(T.yaw) <= goal.heading->tolerance_rad ? Phase::kDocked : Phase::kSquare;
  }
  const bool is_short = T.x < -kRollsM && std::abs(T.y) <= 0.5 * goal.tolerance_m;
  return is_short ? Phase::kFollowLine : Phase::kBackOff;
}

DockingStep Docking::step(const GoalInBase& goal) const {
  using Kind = DockingStep::Kind;
  const geometry::SE2 T = T_goal_base(goal);
  DockingStep step;
  switch (phase_) {
    case Phase::kStage:
      step.kind = Kind::kPlan;
      step.staging_base = T.inverse() * Eigen::Vector2d(-params_.staging_m, 0.0);
      return step;
    case Phase::kAlign:
    case Phase::kSquare:
      step.kind = Kind::kMove;
      step.yaw_rate_rad_s = -std::copysign(
          std::clamp(kYawRatePerRad * std::abs(T.yaw), kMinYawRate, kMaxYawRate), T.yaw);
      step.reason = Why::kDockTurns;
      return step;
    case Phase::kFollowLine:
      return follow_line(T);
    case Phase::kBackOff:
      step.kind = Kind::kMove;
      step.forward_mps = -kBackOffMps;
      step.reason = Why::kDockBacksOff;
      return step;
    case Phase::kDocked:
      step.kind = Kind::kDocked;
      return step;
    case Phase::kFailed:
      step.kind = Kind::kFailed;
      step.reason = Why::kDockFailed;
      return step;
    case Phase::kSettle:
      break;
  }
  step.reason = Why::kDockSettles;
  return step;
}

// The distance y to the line and the angle to it decay critically damped, with s along the line:
// y'' = -y / L^2 - 2 y' / L, where y' is the angle and y'' the curvature.
DockingStep Docking::follow_line(const geometry::SE2& T_goal_base) const {
  const double wanted_rad =
      std::clamp(-T_goal_base.y / (2.0 * params_.line_m), -kSteepestRad, kSteepestRad);
  const double curvature = std::clamp(2.0 / params_.line_m * (wanted_rad - T_goal_base.yaw),
                                      -kMaxCurvature, kMaxCurvature);
  DockingStep step;
  step.kind = DockingStep::Kind::kMove;
  step.forward_mps = std::clamp(kSpeedPerMetre * -T_goal_base.x, kMinMps, params_.speed_mps);
  step.yaw_rate_rad_s = curvature * step.forward_mps;
  step.reason = Why::kDocks;
  return step;
}

}  // namespace nodmap::navigator
