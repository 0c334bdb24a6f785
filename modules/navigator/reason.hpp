// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace nodmap::navigator {

/// Why the robot does what it does. reason.cpp has the sentence for each.
enum class Why : std::uint8_t {
  kNothingToAdd,

  // Why the robot must not drive: the inhibit reasons.
  kStopped,  // by whom
  kVoidGoal,
  kLostPose,
  kNoInput,      // which
  kStaleInput,   // which
  kFutureInput,  // which
  kTwoSenders,   // of which channel
  kStalledServo,
  kVoidFence,
  kNoPoseInFence,
  kOutsideFence,
  kGoalOutsideFence,
  kDocksByPlanOnly,
  kMapMisfit,

  // Brake and Turn.
  kApproach,
  kSomebodyClose,
  kGivesWay,
  kSlowsDown,
  kFirstLook,
  kNoSpeed,
  kObstacleAhead,
  kTurnsToFree,
  kLooksAhead,
  kNoFreeDirection,
  kFreeAhead,
  kBacksUpTrail,
  kNoWayBack,
  kTouches,
  kLeavesContact,

  // To a goal by plan.
  kPlans,
  kNoMotion,
  kCannotMove,
  kSqueezes,
  kNoPathLooks,
  kNoPath,
  kBacksUp,
  kBacksOut,
  kTurnsToPath,

  // Docking.
  kDockTurns,
  kDockBacksOff,
  kDockFailed,
  kDockSettles,
  kDockBlocked,
  kDocks,
};

/// A reason, and what its sentence names: an input, a channel, or who pressed the stop.
struct Reason {
  Why why = Why::kNothingToAdd;
  std::string about;  ///< empty where the sentence names nothing

  Reason() = default;
  Reason(Why why_, std::string about_ = {})  // NOLINT: every Why is a Reason
      : why(why_), about(std::move(about_)) {}

  [[nodiscard]] bool operator==(const Reason&) const = default;
};

/// One sentence; empty for kNothingToAdd.
[[nodiscard]] std::string to_text(const Reason& reason);

}  // namespace nodmap::navigator
