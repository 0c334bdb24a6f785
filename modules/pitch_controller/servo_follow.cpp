// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/servo_follow.hpp"

#include <algorithm>

namespace nodmap::pitch_controller {

ServoFollow::ServoFollow(const SweepPlan& plan, double acceleration_rad_s2)
    : acceleration_rad_s2_(acceleration_rad_s2),
      plan_(plan),
      least_rate_rad_s_(plan.nod.rate_rad_s),
      most_rate_rad_s_(plan.nod.rate_rad_s) {}

void ServoFollow::set_plan(const SweepPlan& plan) {
  plan_ = plan;
  least_rate_rad_s_ = std::min(least_rate_rad_s_, plan.nod.rate_rad_s);
  most_rate_rad_s_ = std::max(most_rate_rad_s_, plan.nod.rate_rad_s);
}

void ServoFollow::add(const MeasuredSweep& sweep) {
  before_last_ = last_;
  last_ = {sweep.mean_rate_rad_s(acceleration_rad_s2_) / least_rate_rad_s_,
           sweep.peak_rate_rad_s / most_rate_rad_s_};
  if (sweep.is_upwards) {
    short_of_max_rad_ = std::max(0.0, plan_.sweep.max_rad - sweep.span.max_rad);
  } else {
    short_of_min_rad_ = std::max(0.0, sweep.span.min_rad - plan_.sweep.min_rad);
  }
  least_rate_rad_s_ = most_rate_rad_s_ = plan_.nod.rate_rad_s;
}

PitchInterval ServoFollow::reached(const SweepPlan& plan) const {
  return {plan.sweep.min_rad + short_of_min_rad_, plan.sweep.max_rad - short_of_max_rad_};
}

double ServoFollow::peak_rate_rad_s(const SweepPlan& plan) const {
  return plan.nod.rate_rad_s * std::max({1.0, last_.peak, before_last_.peak});
}

NodMotion ServoFollow::motion(const SweepPlan& plan, const MeasuredSweep& present) const {
  NodMotion nod;
  nod.ends = {std::min(plan.sweep.min_rad, present.span.min_rad),
              std::max(plan.sweep.max_rad, present.span.max_rad)};
  nod.rate_rad_s = plan.nod.rate_rad_s * std::min({1.0, last_.mean, before_last_.mean});
  nod.reversal_s = plan.nod.reversal_s;
  // A sweep that takes longer than that is slower.
  if (present.duration_s > nod.reversal_s) {
    nod.rate_rad_s =
        std::min(nod.rate_rad_s, nod.ends.range_rad() / (present.duration_s - nod.reversal_s));
  }
  return nod;
}

}  // namespace nodmap::pitch_controller
