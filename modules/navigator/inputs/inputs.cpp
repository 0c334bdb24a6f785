// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/inputs/inputs.hpp"

#include <algorithm>
#include <utility>

#include "common/geometry/angle.hpp"
#include "common/geometry/pose_tolerance.hpp"
#include "modules/navigator/geofence.hpp"

namespace nodmap::navigator {
namespace {

// Of the fastest speed, while the pose is DEGRADED and the goal may be near.
constexpr double kDegradedSpeedRatio = 0.5;
constexpr double kGoalSigmas = 3.0;

// A pose that moves the robot farther in map than this puts it elsewhere. Known walls that are so
// far off would close doors.
constexpr geometry::PoseTolerance kSamePlace{.distance_m = 1.0,
                                             .rotation_rad = geometry::deg_to_rad(15.0)};

}  // namespace

// Senders repeat their goal. Whoever gave it in a frame that is gone has not given it in this one.
void Inputs::take_goal(const std::optional<GoalInMap>& new_goal) {
  const bool is_repeated = goal && new_goal && new_goal->utime == goal->utime &&
                           geometry::is_within(new_goal->T_map_goal, goal->T_map_goal, {});
  is_goal_void = is_goal_void && is_repeated;
  goal = new_goal;
}

bool Inputs::correct_pose(const geometry::SE2& T_map_odom) {
  const geometry::SE2 before = std::exchange(pose.T_map_odom, T_map_odom);
  return odometry && !geometry::is_within(before * odometry->T_odom_base,
                                          T_map_odom * odometry->T_odom_base, kSamePlace);
}

void Inputs::forget_odom_frame() {
  map.reset();
  // A goal in map could be anywhere in the new frame, until the next pose; without 2D SLAM there is
  // none.
  is_goal_void = is_goal_void || (goal && !pose.stamp && !pose.is_lost);
  pose.is_lost = pose.is_lost || pose.stamp;
  pose.stamp.reset();
  stamps.map.reset();
  stamps.scan.reset();
}

void Inputs::forget_map_frame() {
  is_goal_void = goal.has_value();
  is_fence_void = geofence != nullptr;
}

Situation Inputs::situation(const DriveParams& drive) const {
  Situation now;
  now.stamp = *stamps.odometry;
  now.T_odom_base = odometry->T_odom_base;
  now.T_map_odom = pose.T_map_odom;
  now.points_base = move_to_base(map->points_map, map->T_odom_map, odometry->T_odom_base);
  now.forward_mps = odometry->forward_mps;
  now.yaw_rate_rad_s = odometry->yaw_rate_rad_s;
  now.max_forward_mps = permitted_mps(drive);
  now.sweep_count = sweep_count;
  now.geofence = geofence;
  now.map_2d = map_2d;
  now.laser_is_held = laser_is_held;
  if (goal) {
    const geometry::SE2 T_base_goal = T_map_base().inverse() * goal->T_map_goal;
    now.goal = GoalInBase{T_base_goal.translation(), goal->tolerance_m};
    if (goal->heading_tolerance_rad) {
      now.goal->heading = {T_base_goal.yaw, *goal->heading_tolerance_rad};
    }
  }
  return now;
}

GoalState Inputs::goal_state() const {
  if (!goal) {
    return GoalState::kNone;
  }
  const bool is_inside = geofence == nullptr || geofence->contains(goal->T_map_goal.translation());
  return is_inside ? GoalState::kInside : GoalState::kOutsideFence;
}

// Whether the goal may be this near, if the pose follows odometry in some or all directions, as
// along a bare corridor. Farther from the goal this error is no reason to be slow: obstacles are
// measured, whatever the pose.
bool Inputs::may_be_at_goal() const {
  const Eigen::Vector2d p_map = pose.T_map_odom * odometry->T_odom_base.translation();
  return (goal->T_map_goal.translation() - p_map).norm() <
         goal->tolerance_m + kGoalSigmas * pose.sigma_m;
}

// The fastest speed that the pitch controller and the pose allow.
double Inputs::permitted_mps(const DriveParams& drive) const {
  if (goal && pose.is_degraded && may_be_at_goal()) {
    return std::min(max_forward_mps, kDegradedSpeedRatio * drive.max_forward_mps);
  }
  return max_forward_mps;
}

}  // namespace nodmap::navigator
