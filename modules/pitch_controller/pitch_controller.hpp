// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"
#include "modules/pitch_controller/chosen_arc.hpp"
#include "modules/pitch_controller/params.hpp"
#include "modules/pitch_controller/servo_follow.hpp"
#include "modules/pitch_controller/speed_bound.hpp"
#include "modules/pitch_controller/sweep_meter.hpp"
#include "modules/pitch_controller/sweep_plan.hpp"
#include "modules/pitch_controller/sweep_regulator.hpp"
#include "modules/pitch_controller/unseen_places.hpp"

namespace nodmap::pitch_controller {

/// Why driving is inhibited. The speed bound is 0 unless the reason is kNone.
enum class InhibitReason : std::uint8_t {
  kNone,
  kNoOdometry,  ///< odometry is missing or stale
  kNoPitch,     ///< the pitch is missing or stale
  kStalled,
  kNotNodding,  ///< not nodding, or fewer than two complete sweeps so far
  kPitchGaps,   ///< the same, because readings are too far apart to measure a sweep
  kNotLevel,    ///< fixed mode only
};

/// The sweep to command from now on, and the speed at which the robot may drive meanwhile.
struct PitchDecision {
  time::Timestamp stamp{};
  PitchInterval sweep;
  double sweep_s = 0.0;
  double max_forward_mps = 0.0;
  InhibitReason inhibited = InhibitReason::kNone;
};

/// Number of sweeps measured from end to end, and of those among them that took less than 15 or
/// more than 500 scan periods (paper, IV B).
struct SweepCounts {
  std::int64_t complete = 0;
  std::int64_t too_short = 0;
  std::int64_t too_long = 0;
};

/// Adapts the sweeps to the robot's speed (paper, II), and limits the speed to what the sweeps can
/// detect in time:
///
///     speed ──> SweepPlanner ──planned──> SweepRegulator ──> command
///                      └──────┐                 ^
///     pitch ──> SweepMeter ───┼──measured───────┤
///                             └──> ServoFollow ─┴──> speed_bound ──> max_forward_mps
///     speed, pitch ──> UnseenPlaces ───────────────────^
///
/// The plan depends on the speed, and the bound on the sweeps to come: those of the plan, as the
/// servo has followed it so far. They cannot trap each other at a low speed: a sweep planned for a
/// speed always allows a greater one, because its lines are dense enough for 1.4 times the required
/// distance. The robot accelerates as the laser measures what may have appeared before.
///
/// Times are the stamps of the messages; no clock is read.
class PitchController {
 public:
  explicit PitchController(const PitchControllerParams& params);

  /// Adds a forward speed measured by odometry, metres per second, as plausible as SensorInput lets
  /// it be.
  void add_speed(time::Timestamp stamp, double forward_mps);
  void add_pitch(const PitchReading& reading);
  /// Adds what the navigator says of the arc that it has chosen. Used only if the parameters ask
  /// for it, and while it is fresh. Whatever it says, the bound is that of the sweeps planned.
  void add_chosen_arc(const ChosenArc& arc) { arc_ = arc; }

  /// To be called with the time of each new measurement. Returns a decision every 20 ms and at each
  /// reversal of the head.
  [[nodiscard]] std::optional<PitchDecision> decide(time::Timestamp now);

  [[nodiscard]] const SweepPlan& plan() const { return plan_; }
  [[nodiscard]] const SweepCounts& sweep_counts() const { return counts_; }

 private:
  struct Speed {
    time::Timestamp stamp{};
    double forward_mps = 0.0;
  };

  /// Forward speed by odometry, m/s; 0 if it is unknown or backwards.
  [[nodiscard]] double present_mps() const;
  /// At most 1 s, so that a clock that was set has little effect; `at_first_s` before the first
  /// decision.
  [[nodiscard]] double since_decision_s(time::Timestamp now, double at_first_s) const;
  void plan_for_present_speed(time::Timestamp now);
  [[nodiscard]] NeededView present_view(time::Timestamp now) const;
  void plan_for_view(const NeededView& view);
  void add_unseen_place(time::Timestamp now);
  void count(const MeasuredSweep& sweep);
  void regulate(const MeasuredSweep& sweep);
  [[nodiscard]] bool is_fresh(time::Timestamp stamp, time::Timestamp now) const;
  [[nodiscard]] InhibitReason inhibit_reason(time::Timestamp now) const;
  [[nodiscard]] double bound_of(const SweepPlan& plan) const;
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
  std::optional<ChosenArc> arc_;
  std::optional<time::Timestamp> decided_;
  double planned_mps_ = 0.0;
  double looking_mps_ = 0.0;  // the area of interest is at most as wide as at this speed
  double told_mps_ = 0.0;     // the bound of the last decision
  NeededView view_;           // that the sweep is planned for
  SweepPlan plan_;
  double plans_bound_mps_ = 0.0;
  double commanded_s_ = 0.0;
  ServoFollow follow_;
  UnseenPlaces unseen_;
  double turned_rad_ = 0.0;     // by the head since the last decision, up and down
  SweepPlan plan_at_reversal_;  // the plan at the start of the present sweep
  bool plan_held_ = false;      // the plan has not changed since then
  bool has_reversed_ = false;   // since the last decision
};

}  // namespace nodmap::pitch_controller
