// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/pitch_controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::pitch_controller {
namespace {

constexpr time::Duration kPeriod = 20ms;
// A stamp that steps back by as much is not one of another process: the clock was set.
constexpr time::Duration kClockWasSet = 1s;

// A sweep that takes this much longer than commanded counts as not nodding.
constexpr double kLateFactor = 2.0;
constexpr time::Duration kLate = 200ms;

// Rate at which the speed that determines the width of the area of interest may fall: after a stop
// from 1 m/s the area takes ten seconds to open completely.
constexpr double kWideningMps2 = 0.1;

// Plans whose sweep durations differ by a smaller fraction count as the same for the regulator.
constexpr double kSameTime = 0.05;
constexpr double kSameRad = geometry::deg_to_rad(1.0);

// Fixed mode: within this pitch the laser plane meets neither floor nor ceiling within 10 m.
constexpr double kLevelRad = geometry::deg_to_rad(2.0);
constexpr double kHoldS = 1.0;

// What appears nearer than the required distance of this speed, 0.9 m, may be touched by a robot
// that starts: it may get there before the laser has passed again.
constexpr double kMinProtectedMps = 0.5;

bool is_same(const SweepPlan& a, const SweepPlan& b) {
  return std::abs(a.sweep_s - b.sweep_s) < kSameTime * b.sweep_s &&
         std::abs(a.sweep.min_rad - b.sweep.min_rad) < kSameRad &&
         std::abs(a.sweep.max_rad - b.sweep.max_rad) < kSameRad;
}

}  // namespace

PitchController::PitchController(const PitchControllerParams& params)
    : params_(params),
      corridor_(VirtualCorridor::of(params.robot)),
      planner_(params.robot, params.detection, params.speed.fast_mps),
      regulator_(params.regulator),
      rising_(params.speed.acceleration_mps2),
      plan_(planner_.plan(0.0)),
      commanded_s_(plan_.sweep_s),
      follow_(plan_, params.robot.head.pitch_acceleration_rad_s2),
      plan_at_reversal_(plan_) {}

void PitchController::add_speed(time::Timestamp stamp, double forward_mps) {
  speed_ = Speed{stamp, forward_mps};
}

void PitchController::add_pitch(const PitchReading& reading) {
  turned_rad_ += pitch_ ? std::abs(reading.pitch_rad - pitch_->pitch_rad) : 0.0;
  pitch_ = reading;
  if (const auto sweep = meter_.add(reading)) {
    count(*sweep);
    if (sweep->is_complete) {
      follow_.add(*sweep);
    }
    // UnseenPlaces knows angles only: the time of a reversal counts as the angle that the head
    // turns in that time.
    const NodMotion nod = follow_.motion(plan_, meter_.present());
    turned_rad_ += nod.rate_rad_s * nod.reversal_s;
    regulate(*sweep);
    has_reversed_ = true;
  }
}

std::optional<PitchDecision> PitchController::decide(time::Timestamp now) {
  // The stamps of two processes interleave. Time that ran twice would let the bound rise too fast.
  if (decided_ && now < *decided_ && *decided_ - now < kClockWasSet) {
    now = *decided_;
  }
  const time::Duration since = decided_ ? now - *decided_ : kPeriod;
  if (since >= 0us && since < kPeriod && !has_reversed_) {
    return std::nullopt;
  }
  const double dt_s = since_decision_s(now, time::seconds(kPeriod));
  plan_for_present_speed(now);
  decided_ = now;
  has_reversed_ = false;

  PitchDecision decision;
  decision.stamp = now;
  decision.inhibited = inhibit_reason(now);
  const bool may_drive = decision.inhibited == InhibitReason::kNone;
  if (params_.mode == Mode::kFixed) {
    decision.max_forward_mps = may_drive ? bound_of_level_laser() : 0.0;
    decision.sweep_s = kHoldS;
    return decision;
  }
  decision.max_forward_mps = told_mps_ =
      rising_.limit(may_drive ? plans_bound_mps_ : 0.0, present_mps(), dt_s);
  commanded_s_ = regulator_.command_s(plan_.sweep_s, plan_.fastest_s, plan_.slowest_s);
  decision.sweep = plan_.sweep;
  decision.sweep_s = commanded_s_;
  return decision;
}

double PitchController::present_mps() const {
  return speed_ ? std::max(speed_->forward_mps, 0.0) : 0.0;
}

double PitchController::since_decision_s(time::Timestamp now, double at_first_s) const {
  return decided_ ? std::clamp(time::seconds(now - *decided_), 0.0, 1.0) : at_first_s;
}

void PitchController::plan_for_present_speed(time::Timestamp now) {
  // Without odometry the plan stays as it is, because the robot may still be rolling.
  if (speed_ && is_fresh(speed_->stamp, now)) {
    const double dt_s = since_decision_s(now, 1.0);
    // Driving backwards is planned like standstill: the robot is slow, and the laser looks the
    // other way. While the robot brakes, the planned speed falls no faster than the assumed
    // deceleration: a wide nod does not look far enough ahead for the speed that the robot may
    // still have.
    planned_mps_ =
        std::max(present_mps(), planned_mps_ - params_.robot.braking.deceleration_mps2 * dt_s);
    // The part of the area beyond the corridor is for looking around while the robot is stationary.
    // During a short stop it costs more than it is worth: two wide sweeps, and twice the reaction
    // time when the robot continues.
    looking_mps_ = std::max(planned_mps_, looking_mps_ - kWideningMps2 * dt_s);
  }
  add_unseen_place(now);
  plan_for_view(present_view(now));
  follow_.set_plan(plan_);
  plan_held_ = plan_held_ && is_same(plan_, plan_at_reversal_);
}

NeededView PitchController::present_view(time::Timestamp now) const {
  if (!params_.follows_path || !arc_ || !is_fresh(arc_->stamp, now)) {
    return {};
  }
  return needed_view(*arc_, present_mps(), told_mps_, params_.robot.braking,
                     params_.detection.processing_s);
}

// Longer sweeps allow less. Where they would make the robot brake, those for the last view remain
// until the laser has measured what may have appeared.
void PitchController::plan_for_view(const NeededView& view) {
  plan_ = planner_.plan(planned_mps_, looking_mps_, view);
  plans_bound_mps_ = bound_of(plan_);
  const NeededView last = std::exchange(view_, view);
  const bool is_same_view = last.used_m == view.used_m && last.floor_from_m == view.floor_from_m;
  if (is_same_view || plans_bound_mps_ >= present_mps()) {
    return;
  }
  const SweepPlan plan = planner_.plan(planned_mps_, looking_mps_, last);
  const double bound_mps = bound_of(plan);
  if (bound_mps > plans_bound_mps_) {
    plan_ = plan;
    plans_bound_mps_ = bound_mps;
    view_ = last;
  }
}

void PitchController::add_unseen_place(time::Timestamp now) {
  const double forward_mps = present_mps();
  const double protected_mps = std::max(forward_mps, kMinProtectedMps);
  // With the plan of the last decision, by which the head has turned since.
  const NodMotion nod = follow_.motion(plan_, meter_.present());
  unseen_.advance(since_decision_s(now, 0.0) * forward_mps, std::exchange(turned_rad_, 0.0));
  unseen_.add(params_.robot.braking.required_distance_m(
      protected_mps, params_.detection.reaction_s(planner_.plan(protected_mps).sweep_s)));
  unseen_.forget_measured(nod, revisit_s(corridor_, nod, unseen_.least_protected_m(), forward_mps));
}

void PitchController::count(const MeasuredSweep& sweep) {
  if (!sweep.is_complete) {
    return;
  }
  const double scans = std::round(sweep.duration_s / params_.detection.scan_period_s);
  ++counts_.complete;
  counts_.too_short += scans < kMinScans ? 1 : 0;
  counts_.too_long += scans > kMaxScans ? 1 : 0;
}

void PitchController::regulate(const MeasuredSweep& sweep) {
  // If the plan has changed during the sweep, the sweep had no single set point.
  const bool as_planned = sweep.is_complete && plan_held_ &&
                          std::abs(sweep.span.range_rad() - plan_.sweep.range_rad()) < kSameRad;
  if (as_planned) {
    regulator_.add(plan_.sweep_s, sweep.duration_s);
  }
  plan_at_reversal_ = plan_;
  plan_held_ = true;
}

bool PitchController::is_fresh(time::Timestamp stamp, time::Timestamp now) const {
  // A stamp from the future is not trusted either: one of the two clocks is wrong.
  return std::abs(time::seconds(now - stamp)) <= params_.input_timeout_s;
}

InhibitReason PitchController::inhibit_reason(time::Timestamp now) const {
  if (!speed_ || !is_fresh(speed_->stamp, now)) {
    return InhibitReason::kNoOdometry;
  }
  if (!pitch_ || !is_fresh(pitch_->stamp, now)) {
    return InhibitReason::kNoPitch;
  }
  if (pitch_->is_stalled) {
    return InhibitReason::kStalled;
  }
  if (params_.mode == Mode::kFixed) {
    return std::abs(pitch_->pitch_rad) <= kLevelRad ? InhibitReason::kNone
                                                    : InhibitReason::kNotLevel;
  }
  const bool late = meter_.present().duration_s > kLateFactor * commanded_s_ + time::seconds(kLate);
  if (meter_.last_two_sweeps() && !late) {
    return InhibitReason::kNone;
  }
  return meter_.has_gap() && !late ? InhibitReason::kPitchGaps : InhibitReason::kNotNodding;
}

// The bound of the sweeps to come. What the laser has measured counts no more for what appears
// from now on; it shows how the servo follows the plan.
double PitchController::bound_of(const SweepPlan& plan) const {
  const DetectionParams& detection = params_.detection;
  ComingSweeps sweeps;
  sweeps.view = clear_view(corridor_, follow_.reached(plan),
                           follow_.peak_rate_rad_s(plan) * detection.scan_period_s,
                           detection.visible_obstacle_m, detection.look_ahead_m);
  sweeps.nod = follow_.motion(plan, meter_.present());
  sweeps.short_of_m = std::max(0.0, sweeps.view.near_m - plan.d_min_m);
  return std::min(speed_bound(sweeps, unseen_, corridor_, params_.robot.braking, detection),
                  params_.speed.top_mps);
}

// The speed bound of a 2D scanner, which is blind above and below its plane.
double PitchController::bound_of_level_laser() const {
  const DetectionParams& detection = params_.detection;
  const double reaction_s = detection.scan_period_s + detection.processing_s;
  return std::min(params_.robot.braking.permitted_mps(detection.look_ahead_m, reaction_s),
                  params_.speed.top_mps);
}

}  // namespace nodmap::pitch_controller
