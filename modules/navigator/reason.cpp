// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/reason.hpp"

#include <array>
#include <cstddef>

namespace nodmap::navigator {
namespace {

struct Sentence {
  Why why;
  const char* text;  // % stands for Reason::about
};

// The sentence of each reason, in the order of Why.
constexpr auto kSentences = std::to_array<Sentence>({
    {Why::kNothingToAdd, ""},
    {Why::kStopped, "Stopped by %."},
    {Why::kVoidGoal, "The map in which the goal was given is gone: waits for a new goal."},
    {Why::kLostPose, "2D SLAM is lost, so the direction to the goal is not known."},
    {Why::kNoInput, "There is no %."},
    {Why::kStaleInput, "The % is stale."},
    {Why::kFutureInput, "Odometry is stale, or the % is from the future."},
    {Why::kTwoSenders, "Two processes send %."},
    {Why::kStalledServo, "The pitch servo is stalled."},
    {Why::kVoidFence, "2D SLAM has started anew: the geofence must be confirmed by a release."},
    {Why::kNoPoseInFence, "There is a geofence, but no pose from 2D SLAM."},
    {Why::kOutsideFence, "The robot is outside the geofence."},
    {Why::kGoalOutsideFence, "The goal is outside the geofence."},
    {Why::kDocksByPlanOnly, "Docks only with planner.use_planner and local_map.use_local_map."},
    {Why::kMapMisfit, "Obstacle map and odometry do not fit together."},
    {Why::kApproach, "Something approaches: waits until it has passed."},
    {Why::kSomebodyClose, "Somebody is close beside or behind: waits until they have passed."},
    {Why::kGivesWay, "Gives way to somebody."},
    {Why::kSlowsDown, "Slows down for an obstacle."},
    {Why::kFirstLook, "Waits until the laser has looked."},
    {Why::kNoSpeed, "The pitch controller allows no speed."},
    {Why::kObstacleAhead, "There is an obstacle ahead."},
    {Why::kTurnsToFree, "Turns to a free direction."},
    {Why::kLooksAhead, "Waits until the laser has seen what is ahead."},
    {Why::kNoFreeDirection, "No direction is free; will try again."},
    {Why::kFreeAhead, "The direction ahead is free."},
    {Why::kBacksUpTrail, "Cannot turn: backs up along its trail."},
    {Why::kNoWayBack, "Cannot turn, and no path back is known to be free."},
    {Why::kTouches, "The wheels slip: has run into something that the laser does not see."},
    {Why::kLeavesContact, "Backs up from something that the laser does not see."},
    {Why::kPlans, "Plans the path to the goal."},
    {Why::kNoMotion, "No motion is free."},
    {Why::kCannotMove, "Cannot move: for a while no motion has been free."},
    {Why::kSqueezes, "Squeezes through a narrow place."},
    {Why::kNoPathLooks, "There is no path to the goal: looks around."},
    {Why::kNoPath, "There is no path to the goal."},
    {Why::kBacksUp, "Backs up."},
    {Why::kBacksOut, "Backs out of where it was set down, by its range finders."},
    {Why::kTurnsToPath, "Turns towards the path."},
    {Why::kDockTurns, "Docks: turns to the heading of the goal."},
    {Why::kDockBacksOff, "Docks: backs off for another try."},
    {Why::kDockFailed, "Cannot dock: the last try was not accurate enough, or was blocked."},
    {Why::kDockSettles, "Docks: waits until its pose is certain."},
    {Why::kDockBlocked, "Docks: waits until the path is free."},
    {Why::kDocks, "Docks."},
});

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kSentences.size(); ++i) {
    if (static_cast<std::size_t>(kSentences[i].why) != i) {
      return false;
    }
  }
  return kSentences.back().why == Why::kDocks;
}
static_assert(is_in_order(), "Each reason has a sentence, in the order of Why.");

}  // namespace

std::string to_text(const Reason& reason) {
  std::string text = kSentences.at(static_cast<std::size_t>(reason.why)).text;
  if (const auto place = text.find('%'); place != std::string::npos) {
    text.replace(place, 1, reason.about);
  }
  return text;
}

}  // namespace nodmap::navigator
