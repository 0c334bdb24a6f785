// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "modules/pitch_controller/params.hpp"
#include "modules/pitch_controller/speed_bound.hpp"
#include "modules/pitch_controller/sweep_meter.hpp"
#include "modules/pitch_controller/sweep_plan.hpp"
#include "modules/pitch_controller/sweep_regulator.hpp"

namespace nodmap::pitch_controller {

/// Why nobody may drive.
enum class Hindrance : std::uint8_t {
  kNone,
  kNoOdometry,  ///< or it is old
  kNoPitch,     ///< or it is old
  kStalled,
  kNotNodding,  ///< or not for two whole sweeps yet
  kNotLevel,    ///< fixed mode only
};

/// How to nod from now on, and how fast the robot may go meanwhile.
struct PitchDecision {
  std::int64_t time_us = 0;
  PitchInterval sweep;
  double sweep_s = 0.0;
  double max_forward_mps = 0.0;
  Hindrance hindrance = Hindrance::kNone;
};

/// Fits the nod to the speed (paper, II), and bounds the speed by the nod:
///
///     speed ──> SweepPlanner ──T*──> SweepRegulator ──> command
///     pitch ──> SweepMeter ──T_h──────────^   └──> speed_bound ──> max_forward_mps
///
/// The plan follows the speed, the bound follows what was MEASURED of the nod. There is no
/// deadlock, for a nod planned for a speed always allows a greater one: its lines are dense enough
/// for about twice d_min. So the robot speeds up as the nod narrows, and not before.
///
/// Times are the stamps of the messages, microseconds; no clock is read.
class PitchController {
 public:
  explicit PitchController(const PitchControllerParams& params);

  /// Forward speed by odometry, metres per second, finite.
  void add_speed(std::int64_t time_us, double forward_mps);
  void add_pitch(const PitchReading& reading);

  /// To be called with each new measurement's time. A decision every 20 ms, and at each turn.
  [[nodiscard]] std::optional<PitchDecision> decide(std::int64_t now_us);

  [[nodiscard]] const SweepPlan& plan() const { return plan_; }

 private:
  struct Speed {
    std::int64_t time_us = 0;
    double forward_mps = 0.0;
  };

  void plan_for_present_speed(std::int64_t now_us);
  void regulate(const MeasuredSweep& sweep);
  [[nodiscard]] bool is_fresh(std::int64_t time_us, std::int64_t now_us) const;
  [[nodiscard]] Hindrance hindrance(std::int64_t now_us) const;
  void allow(double bound_mps, std::int64_t since_us);
  [[nodiscard]] double max_forward_mps() const;

  PitchControllerParams params_;
  VirtualCorridor corridor_;
  Stopping stopping_;
  SweepPlanner planner_;
  SweepRegulator regulator_;
  SweepMeter meter_;

  std::optional<Speed> speed_;
  std::optional<PitchReading> pitch_;
  std::optional<std::int64_t> decided_us_;
  double allowed_mps_ = 0.0;
  double planned_mps_ = 0.0;
  SweepPlan plan_;
  double commanded_s_ = 0.0;
  SweepPlan plan_at_turn_;   // of the sweep under way,
  bool plan_held_ = false;   // and whether it has been that all along
  bool has_turned_ = false;  // since the last decision
};

}  // namespace nodmap::pitch_controller
