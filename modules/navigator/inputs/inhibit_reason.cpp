// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/inputs/inhibit_reason.hpp"

#include "modules/navigator/behaviours/corridor.hpp"
#include "modules/navigator/geofence.hpp"

namespace nodmap::navigator {
namespace {

// The base cannot drive faster; a map farther away than that belongs to another odom frame.
constexpr double kTopSpeedMps = 5.2;

// POSE_2D comes once a sweep, which takes up to 1 s. A pose older than this is stale: by odometry
// alone, at 1.5 m/s and with wheels 3 % off, the robot is 9 cm elsewhere by then.
constexpr time::Duration kFencePose = 2s;

// With a geofence the robot drives only while it knows that it is inside. If it has got outside,
// it does not drive back: nothing says that the path back is allowed. It is outside if any part of
// the boundary is so deep within the body that Brake would ignore it there.
std::optional<Reason> reason_by_geofence(const Inputs& inputs, const robot::Footprint& body) {
  if (inputs.geofence == nullptr) {
    return std::nullopt;
  }
  if (inputs.is_fence_void) {
    return Why::kVoidFence;
  }
  if (!inputs.pose.stamp || inputs.pose.is_lost ||
      std::chrono::abs(*inputs.stamps.odometry - *inputs.pose.stamp) > kFencePose) {
    return Why::kNoPoseInFence;
  }
  if (!inputs.geofence->contains(inputs.T_map_base(), body.grown(-kErrorOfMapM, -kErrorOfMapM))) {
    return Why::kOutsideFence;
  }
  if (inputs.goal_state() == GoalState::kOutsideFence) {
    return Why::kGoalOutsideFence;
  }
  return std::nullopt;
}

// Whether the robot cannot have driven from where the obstacle map was made to where it is now.
bool is_map_misfit(const Inputs& inputs) {
  const double age_s =
      time::seconds(std::chrono::abs(*inputs.stamps.odometry - *inputs.stamps.map));
  const double shift_m =
      (inputs.odometry->T_odom_base.translation() - inputs.map->T_odom_map.translation()).norm();
  // 10 cm because the map's pose is interpolated.
  return shift_m > kTopSpeedMps * age_s + 0.1;
}

}  // namespace

std::optional<Reason> inhibit_reason(const Inputs& inputs,
                                     const std::optional<std::string>& contested_channel,
                                     const NavigatorParams& params, const StalenessParams& limits) {
  if (inputs.stopped_by) {
    return Reason(Why::kStopped, *inputs.stopped_by);
  }
  if (inputs.is_goal_void) {
    return Why::kVoidGoal;
  }
  if (inputs.goal && inputs.pose.is_lost) {
    return Why::kLostPose;
  }
  if (auto stale = reason_by_staleness(inputs.stamps, limits, params.local_map.use)) {
    return stale;
  }
  if (contested_channel) {
    return Reason(Why::kTwoSenders, *contested_channel);
  }
  if (inputs.servo_is_stalled) {
    return Why::kStalledServo;
  }
  if (auto reason = reason_by_geofence(inputs, params.robot.body.footprint())) {
    return reason;
  }
  const bool docks = inputs.goal && inputs.goal->heading_tolerance_rad;
  if (docks && !(params.planner.use && params.local_map.use)) {
    return Why::kDocksByPlanOnly;
  }
  if (is_map_misfit(inputs)) {
    return Why::kMapMisfit;
  }
  return std::nullopt;
}

}  // namespace nodmap::navigator
