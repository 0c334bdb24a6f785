// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/geometry/time.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/goal.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/reason.hpp"

namespace nodmap::navigator {

/// The command of docking.
struct DockingStep {
  enum class Kind : std::uint8_t {
    kPlan,    ///< drive to `staging_base` by plan
    kMove,    ///< `forward_mps` and `yaw_rate_rad_s`
    kStay,    ///< be stationary
    kDocked,  ///< stationary at the goal
    kFailed,  ///< stationary, and not at the goal
  };
  Kind kind = Kind::kStay;
  Eigen::Vector2d staging_base = Eigen::Vector2d::Zero();
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  Reason reason;
};

/// Brings the robot to a goal with a heading, to centimetres and a degree: by plan to a staging
/// place straight behind the goal, from there along the line through the goal, and at the end by a
/// rotation on the spot to the heading. The pose is checked when the robot has been stationary for
/// a while. If the error is too large it tries again, from farther back if it is off sideways.
class Docking {
 public:
  /// The staging place counts as reached within this distance.
  static constexpr double kStagingToleranceM = 0.15;

  explicit Docking(const DockingParams& params) : params_(params) {}

  /// Begins anew, for a new goal.
  void reset() { *this = Docking(params_); }

  /// What to do next. `goal` must have a heading.
  [[nodiscard]] DockingStep next(const GoalInBase& goal, time::Timestamp stamp);

  /// Whether it is past the staging place and has not failed.
  [[nodiscard]] bool is_docking() const {
    return phase_ != Phase::kStage && phase_ != Phase::kFailed;
  }
  [[nodiscard]] bool has_failed() const { return phase_ == Phase::kFailed; }

 private:
  enum class Phase : std::uint8_t {
    kStage,
    kAlign,
    kFollowLine,
    kSquare,
    kSettle,
    kBackOff,
    kDocked,
    kFailed
  };

  [[nodiscard]] bool is_done(const GoalInBase& goal, double phase_s) const;
  [[nodiscard]] Phase next_phase(const GoalInBase& goal) const;
  [[nodiscard]] Phase phase_when_late() const;
  [[nodiscard]] static Phase after_settling(const GoalInBase& goal);
  void enter(Phase phase, time::Timestamp stamp);
  [[nodiscard]] DockingStep step(const GoalInBase& goal) const;
  [[nodiscard]] DockingStep follow_line(const geometry::SE2& T_goal_base) const;

  DockingParams params_;
  Phase phase_ = Phase::kStage;
  time::Timestamp phase_began_{};  ///< later by the pauses since then
  time::Timestamp decided_at_{};
  int num_tries_ = 0;
};

}  // namespace nodmap::navigator
