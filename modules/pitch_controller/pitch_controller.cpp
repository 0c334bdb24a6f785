// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/pitch_controller.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::pitch_controller {
namespace {

constexpr std::int64_t kPeriodUs = 20'000;
// Beyond what KURT can do (5.2 m/s); keeps the arithmetic finite.
constexpr double kImpossibleMps = 20.0;

// A sweep takes longer than it should by the servo's fault; by this much it is no nod any more.
constexpr double kLateFactor = 2.0;
constexpr double kLateS = 0.2;

// Plans that differ by less are the same to the regulator.
constexpr double kSameTime = 0.05;
constexpr double kSameRad = geometry::deg_to_rad(1.0);

// Above the present speed: what the wheels' lag needs to follow.
constexpr double kHeadroomMps = 0.2;

// Fixed mode: held within this, the plane meets neither floor nor ceiling within 10 m.
constexpr double kLevelRad = geometry::deg_to_rad(2.0);
constexpr double kHoldS = 1.0;

bool is_same(const SweepPlan& a, const SweepPlan& b) {
  return std::abs(a.sweep_s - b.sweep_s) < kSameTime * b.sweep_s &&
         std::abs(a.sweep.min_rad - b.sweep.min_rad) < kSameRad &&
         std::abs(a.sweep.max_rad - b.sweep.max_rad) < kSameRad;
}

}  // namespace

PitchController::PitchController(const PitchControllerParams& params)
    : params_(params),
      corridor_(VirtualCorridor::of(params)),
      stopping_(Stopping::of(params)),
      planner_(params),
      regulator_(params.regulator_p, params.regulator_i),
      plan_(planner_.plan(0.0)),
      commanded_s_(plan_.sweep_s),
      plan_at_turn_(plan_) {}

void PitchController::add_speed(std::int64_t time_us, double forward_mps) {
  speed_ = Speed{time_us, forward_mps};
}

void PitchController::add_pitch(const PitchReading& reading) {
  pitch_ = reading;
  if (const auto sweep = meter_.add(reading)) {
    regulate(*sweep);
    has_turned_ = true;
  }
}

std::optional<PitchDecision> PitchController::decide(std::int64_t now_us) {
  const std::int64_t since_us = decided_us_ ? now_us - *decided_us_ : kPeriodUs;
  if (since_us >= 0 && since_us < kPeriodUs && !has_turned_) {
    return std::nullopt;
  }
  plan_for_present_speed(now_us);
  decided_us_ = now_us;
  has_turned_ = false;

  PitchDecision decision;
  decision.time_us = now_us;
  decision.hindrance = hindrance(now_us);
  allow(decision.hindrance == Hindrance::kNone ? max_forward_mps() : 0.0, since_us);
  decision.max_forward_mps = allowed_mps_;
  if (params_.mode == Mode::kFixed) {
    decision.sweep_s = kHoldS;
    return decision;
  }
  commanded_s_ = regulator_.command_s(plan_.sweep_s, plan_.fastest_s, plan_.slowest_s);
  decision.sweep = plan_.sweep;
  decision.sweep_s = commanded_s_;
  return decision;
}

// What appeared while the robot was slower did so at the end of a shorter stopping way, and may
// not have been looked at since. Getting faster no quicker than this over a period of the nod, the
// robot can still stop before it, with the brakes' full force.
void PitchController::allow(double bound_mps, std::int64_t since_us) {
  if (params_.mode == Mode::kFixed) {
    allowed_mps_ = bound_mps;
    return;
  }
  const double dt_s = std::clamp(1e-6 * static_cast<double>(since_us), 0.0, 1.0);
  const double present_mps = speed_ ? std::clamp(speed_->forward_mps, 0.0, kImpossibleMps) : 0.0;
  const double from_mps = std::max(allowed_mps_, present_mps);
  allowed_mps_ = std::min(
      {bound_mps, from_mps + params_.acceleration_mps2 * dt_s, present_mps + kHeadroomMps});
}

void PitchController::plan_for_present_speed(std::int64_t now_us) {
  // Without odometry the robot may well still roll: the nod stays what it was.
  if (speed_ && is_fresh(speed_->time_us, now_us)) {
    const double dt_s =
        decided_us_ ? std::clamp(1e-6 * static_cast<double>(now_us - *decided_us_), 0.0, 1.0) : 1.0;
    // Backing up the robot is slow, and the laser looks the other way: it looks around. Braking
    // hard, the nod widens only as fast as the brakes are trusted: a wide nod does not look far
    // enough ahead for the speed the robot may still have.
    const double forward_mps = std::clamp(speed_->forward_mps, 0.0, kImpossibleMps);
    planned_mps_ =
        std::max(forward_mps, planned_mps_ - params_.robot.braking.deceleration_mps2 * dt_s);
  }
  plan_ = planner_.plan(planned_mps_);
  plan_held_ = plan_held_ && is_same(plan_, plan_at_turn_);
}

void PitchController::regulate(const MeasuredSweep& sweep) {
  // Of a sweep whose plan changed under way nobody knows how long it should have taken.
  const bool as_planned = sweep.is_whole && plan_held_ &&
                          std::abs(sweep.span.range_rad() - plan_.sweep.range_rad()) < kSameRad;
  if (as_planned) {
    regulator_.add(plan_.sweep_s, sweep.duration_s);
  }
  plan_at_turn_ = plan_;
  plan_held_ = true;
}

bool PitchController::is_fresh(std::int64_t time_us, std::int64_t now_us) const {
  // A stamp from the future is as little trusted: one of the two clocks is wrong.
  return std::abs(1e-6 * static_cast<double>(now_us - time_us)) <= params_.input_timeout_s;
}

Hindrance PitchController::hindrance(std::int64_t now_us) const {
  if (!speed_ || !is_fresh(speed_->time_us, now_us)) {
    return Hindrance::kNoOdometry;
  }
  if (!pitch_ || !is_fresh(pitch_->time_us, now_us)) {
    return Hindrance::kNoPitch;
  }
  if (pitch_->is_stalled) {
    return Hindrance::kStalled;
  }
  if (params_.mode == Mode::kFixed) {
    return std::abs(pitch_->pitch_rad) <= kLevelRad ? Hindrance::kNone : Hindrance::kNotLevel;
  }
  const bool late = meter_.under_way_s() > kLateFactor * commanded_s_ + kLateS;
  return meter_.period() && !late ? Hindrance::kNone : Hindrance::kNotNodding;
}

double PitchController::max_forward_mps() const {
  if (params_.mode == Mode::kFixed) {
    const double reaction_s = params_.scan_period_s + params_.processing_s;
    return std::min(stopping_.speed_mps(params_.look_ahead_m, reaction_s), params_.top_mps);
  }
  const MeasuredSweep period = *meter_.period();
  ClearView view =
      clear_view(corridor_, period.span, period.peak_rate_rad_s * params_.scan_period_s,
                 params_.visible_obstacle_m, params_.look_ahead_m);
  // What was shown is not shown again where the nod has narrowed since.
  view.near_m = std::max(view.near_m, corridor_.covered_from_m(plan_.area));
  return std::min(speed_bound(view, period.duration_s, stopping_), params_.top_mps);
}

}  // namespace nodmap::pitch_controller
