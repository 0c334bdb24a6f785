// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "modules/navigator/brake.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/rollouts.hpp"

namespace nodmap::navigator {

/// Turns a rollout into a decision that is as slow as safety requires. Forwards it drives as Brake
/// allows, and only where the laser has looked; backwards only over floor that was seen, on the
/// strip that the body has driven; on the spot it rotates as far as there is room.
class SafeMotion {
 public:
  explicit SafeMotion(const NavigatorParams& params);

  /// The best of these rollouts, which are sorted by cost; empty if none can be driven.
  [[nodiscard]] std::optional<Decision> best_of(const std::vector<Rollout>& rollouts,
                                                const Brake& brake, const Situation& now) const;

  /// Empty if the rollout cannot be driven.
  [[nodiscard]] std::optional<Decision> drive(const Rollout& rollout, const Brake& brake,
                                              const Situation& now) const;

  /// A rotation on the spot, not yet slowed down for doubtful ground and people.
  [[nodiscard]] std::optional<Decision> rotate(const Rollout& rollout, const Situation& now) const;

 private:
  [[nodiscard]] std::optional<Decision> move(const Rollout& rollout, const Brake& brake,
                                             const Situation& now) const;
  [[nodiscard]] std::optional<Decision> drive_forwards(const Rollout& rollout, const Brake& brake,
                                                       const Situation& now) const;
  [[nodiscard]] std::optional<Decision> drive_backwards(const Rollout& rollout, const Brake& brake,
                                                        const Situation& now) const;

  robot::Footprint body_;
  TurnParams turn_params_;
  double reaction_s_;
};

}  // namespace nodmap::navigator
