// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/sweep_meter.hpp"
#include "modules/pitch_controller/sweep_plan.hpp"

namespace nodmap::pitch_controller {

/// How the servo follows the plan: what the last two sweeps, one up and one down, were as MEASURED,
/// compared with their plan. Applied to a plan, this predicts the sweeps to come, also while the
/// plan changes.
class ServoFollow {
 public:
  ServoFollow(const SweepPlan& plan, double acceleration_rad_s2);

  /// The plan for the present sweep, whenever it changes.
  void set_plan(const SweepPlan& plan);
  /// The present sweep has ended.
  void add(const MeasuredSweep& sweep);

  /// The pitches that sweeps of this plan reach.
  [[nodiscard]] PitchInterval reached(const SweepPlan& plan) const;
  /// The highest rate of the head in them: it gives the greatest angle between scan lines.
  [[nodiscard]] double peak_rate_rad_s(const SweepPlan& plan) const;
  /// The head's motion in them, at its lowest rate. `present` is the sweep that has not ended yet:
  /// a head that is beyond a new end, or has come from there, needs the time for that angle too.
  [[nodiscard]] NodMotion motion(const SweepPlan& plan, const MeasuredSweep& present) const;

 private:
  /// Measured rates relative to those that were planned during the sweep.
  struct Ratios {
    double mean = 1.0;
    double peak = 1.0;
  };

  double acceleration_rad_s2_;
  SweepPlan plan_;
  double least_rate_rad_s_;  // planned during the present sweep
  double most_rate_rad_s_;
  Ratios last_;
  Ratios before_last_;
  double short_of_min_rad_ = 0.0;  // how far the head stopped short of its last ends
  double short_of_max_rad_ = 0.0;
};

}  // namespace nodmap::pitch_controller
