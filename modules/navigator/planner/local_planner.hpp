// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <utility>

#include "modules/navigator/behaviours/brake.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/rollouts.hpp"
#include "modules/navigator/situation.hpp"
#include "modules/navigator/twist.hpp"

namespace nodmap::navigator {

/// The local planner: chooses the best of many rollouts, and makes of it a decision that is as slow
/// as safety requires. Forwards the robot drives as Brake allows, and so slowly that it stops
/// before a place where the laser has not looked; backwards only over floor that was seen, on the
/// strip that the body has driven; on the spot it rotates as far as there is room. What is safe
/// does not depend on the plan.
class LocalPlanner {
 public:
  /// `creeps`: see Brake.
  LocalPlanner(const NavigatorParams& params, bool creeps);

  /// Drives the best rollout by this plan; empty if none can be driven.
  [[nodiscard]] std::optional<Decision> drive_best(const Situation& now,
                                                   const CostToGo& cost_to_go);

  /// Why the last call of drive_best() that was empty found nothing to drive.
  [[nodiscard]] Reason reason_to_stay() const { return why_stays_; }

  /// Drives the best of these rollouts, which are sorted by cost; empty if none can be driven.
  [[nodiscard]] std::optional<Decision> drive_best_of(std::span<const Rollout> rollouts,
                                                      const Situation& now) const;

  /// Drives one motion; empty if it cannot be driven.
  [[nodiscard]] std::optional<Decision> drive(const Twist& motion, const Situation& now) const;

  /// Rotates on the spot, at most at this yaw rate; empty if there is no room. A robot that drives
  /// slows down on its arc first. Not yet slowed down for doubtful ground and people.
  [[nodiscard]] std::optional<Decision> rotate(double yaw_rate_rad_s, const Situation& now) const;

  /// See Brake.
  [[nodiscard]] Decision slow_down(Reason reason, const Situation& now) const {
    return brake_.slow_down(std::move(reason), now);
  }

 private:
  [[nodiscard]] std::optional<Decision> move(const Twist& motion, const Situation& now) const;
  [[nodiscard]] std::optional<Decision> drive_forwards(const Twist& motion,
                                                       const Situation& now) const;
  [[nodiscard]] Why reason_to_stay(std::span<const Rollout> rollouts, const Situation& now) const;
  [[nodiscard]] double speed_where_looked(double curvature, double limit_mps,
                                          const Situation& now) const;
  [[nodiscard]] std::optional<Decision> drive_backwards(const Twist& motion,
                                                        const Situation& now) const;

  robot::Footprint body_;
  Brake brake_;
  Rollouts rollouts_;
  Why why_stays_ = Why::kNoMotion;
};

}  // namespace nodmap::navigator
