// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "modules/pitch_controller/params.hpp"
#include "modules/pitch_controller/speed_bound.hpp"
#include "modules/pitch_controller/sweep_control.hpp"
#include "modules/pitch_controller/sweep_plan.hpp"

namespace nodmap::pitch_controller {

/// Why driving is inhibited: the speed bound is 0.
enum class InhibitReason : std::uint8_t {
  kNone,
  kNoOdometry,  ///< or it is stale
  kNoPitch,     ///< or it is stale
  kStalled,
  kNotNodding,  ///< or not for two complete sweeps yet
  kNotLevel,    ///< fixed mode only
};

/// How to nod from now on, and how fast the robot may drive meanwhile.
struct PitchDecision {
  std::int64_t time_us = 0;
  PitchInterval sweep;
  double sweep_s = 0.0;
  double max_forward_mps = 0.0;
  InhibitReason inhibited = InhibitReason::kNone;
};

/// Sweeps that were seen from end to end, and those of them that took less than 15 or more than 500
/// scan periods (paper, IV B).
struct SweepCounts {
  std::int64_t complete = 0;
  std::int64_t too_short = 0;
  std::int64_t too_long = 0;
};

/// Fits the nod to the speed (paper, II), and bounds the speed by the nod:
///
///     speed ──> SweepPlanner ──T*──> SweepRegulator ──> command
///     pitch ──> SweepMeter ──T──────────^   └──> speed_bound ──> max_forward_mps
///
/// The plan follows the speed, the bound follows what was MEASURED of the sweeps. They cannot lock
/// each other at a low speed: a sweep planned for a speed always allows a greater one, for its
/// lines are dense enough for about twice d_min. So the robot speeds up as the nod narrows, and not
/// before.
///
/// Times are the stamps of the messages, microseconds; no clock is read.
class PitchController {
 public:
  explicit PitchController(const PitchControllerParams& params);

  /// Forward speed by odometry, metres per second, finite.
  void add_speed(std::int64_t time_us, double forward_mps);
  void add_pitch(const PitchReading& reading);

  /// To be called with the time of each new measurement. Decides every 20 ms, and at each reversal
  /// of the head.
  [[nodiscard]] std::optional<PitchDecision> decide(std::int64_t now_us);

  [[nodiscard]] const SweepPlan& plan() const { return plan_; }
  [[nodiscard]] const SweepCounts& sweep_counts() const { return counts_; }

 private:
  struct Speed {
    std::int64_t time_us = 0;
    double forward_mps = 0.0;
  };

  void plan_for_present_speed(std::int64_t now_us);
  void count(const MeasuredSweep& sweep);
  void regulate(const MeasuredSweep& sweep);
  [[nodiscard]] bool is_fresh(std::int64_t time_us, std::int64_t now_us) const;
  [[nodiscard]] InhibitReason inhibit_reason(std::int64_t now_us) const;
  [[nodiscard]] double bound_of_measured_sweeps() const;
  [[nodiscard]] double bound_of_level_laser() const;

  PitchControllerParams params_;
  VirtualCorridor corridor_;
  SweepPlanner planner_;
  SweepRegulator regulator_;
  SweepMeter meter_;
  RisingBound rising_;
  SweepCounts counts_;

  std::optional<Speed> speed_;
  std::optional<PitchReading> pitch_;
  std::optional<std::int64_t> decided_us_;
  double planned_mps_ = 0.0;
  SweepPlan plan_;
  double commanded_s_ = 0.0;
  SweepPlan plan_at_reversal_;  // of the present sweep,
  bool plan_held_ = false;      // and whether it has not changed since
  bool has_reversed_ = false;   // since the last decision
};

}  // namespace nodmap::pitch_controller
