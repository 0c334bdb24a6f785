// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/reason.hpp"

namespace nodmap::navigator {
namespace {

/// The sentence of each reason; % stands for Reason::about.
const char* sentence_of(Why why) {
  switch (why) {
    case Why::kNothingToAdd:
      return "";
    case Why::kStopped:
      return "Stopped by %.";
    case Why::kLostPose:
      return "2D SLAM is lost: the direction to the goal is not known.";
    case Why::kNoInput:
      return "There is no %.";
    case Why::kStaleInput:
      return "The % is stale.";
    case Why::kFutureInput:
      return "Odometry is stale, or the % is from the future.";
    case Why::kTwoSenders:
      return "Two processes send %.";
    case Why::kStalledServo:
      return "The pitch servo is stalled.";
    case Why::kNoPoseInFence:
      return "There is a geofence, and no pose by 2D SLAM.";
    case Why::kOutsideFence:
      return "The robot is outside of the geofence.";
    case Why::kGoalOutsideFence:
      return "The goal is outside of the geofence.";
    case Why::kDocksByPlanOnly:
      return "Docks only with planner.use_planner and local_map.use_local_map.";
    case Why::kMapMisfit:
      return "Obstacle map and odometry do not fit together.";
    case Why::kApproach:
      return "Something approaches: waits until it has passed.";
    case Why::kSomebodyClose:
      return "Somebody is close beside or behind: waits until he has passed.";
    case Why::kGivesWay:
      return "Gives way to somebody.";
    case Why::kSlowsDown:
      return "Slows down for an obstacle.";
    case Why::kFirstLook:
      return "Waits until the laser has looked.";
    case Why::kNoSpeed:
      return "The pitch controller allows no speed.";
    case Why::kObstacleAhead:
      return "There is an obstacle ahead.";
    case Why::kTurnsToFree:
      return "Turns to a free direction.";
    case Why::kLooksAhead:
      return "Waits until the laser has seen what is ahead.";
    case Why::kNoFreeDirection:
      return "No direction is free; will try again.";
    case Why::kFreeAhead:
      return "The direction ahead is free.";
    case Why::kBacksUpTrail:
      return "Cannot turn: backs up along its trail.";
    case Why::kNoWayBack:
      return "Cannot turn, and no path back is known to be free.";
    case Why::kPlans:
      return "Plans the path to the goal.";
    case Why::kNoMotion:
      return "No motion is free.";
    case Why::kSqueezes:
      return "Squeezes through a narrow place.";
    case Why::kNoPathLooks:
      return "There is no path to the goal: looks around.";
    case Why::kNoPath:
      return "There is no path to the goal.";
    case Why::kBacksUp:
      return "Backs up.";
    case Why::kTurnsToPath:
      return "Turns towards the path.";
    case Why::kDockTurns:
      return "Docks: turns to the heading of the goal.";
    case Why::kDockBacksOff:
      return "Docks: backs off for another try.";
    case Why::kDockFailed:
      return "Cannot dock: the last try was not exact enough, or was blocked.";
    case Why::kDockSettles:
      return "Docks: waits until its pose is sure.";
    case Why::kDockBlocked:
      return "Docks: waits until the path is free.";
    case Why::kDocks:
      return "Docks.";
  }
  return "";
}

}  // namespace

std::string to_text(const Reason& reason) {
  std::string text = sentence_of(reason.why);
  if (const auto place = text.find('%'); place != std::string::npos) {
    text.replace(place, 1, reason.about);
  }
  return text;
}

}  // namespace nodmap::navigator
