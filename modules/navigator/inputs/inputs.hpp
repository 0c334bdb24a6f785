// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/goal.hpp"
#include "modules/navigator/inputs/staleness.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// Where the goal is.
enum class GoalState : std::uint8_t { kNone, kInside, kOutsideFence };

/// The newest values of all inputs. inhibit_reason.hpp says whether the robot may drive on them; if
/// it may, situation() is what it decides on.
struct Inputs {
  struct Odometry {
    std::int64_t seq = 0;
    geometry::SE2 T_odom_base;
    double forward_mps = 0.0;
    double yaw_rate_rad_s = 0.0;
  };
  struct ObstacleMap {
    geometry::SE2 T_odom_map;  ///< of base at the map's stamp
    Points points_map;
  };
  /// By 2D SLAM; identity without it.
  struct MapPose {
    geometry::SE2 T_map_odom;
    double sigma_m = 0.0;                  ///< in its worst direction
    std::optional<time::Timestamp> stamp;  ///< when it was measured; empty before any odometry
    // The state of the last POSE_2D, also of one that was not used because it is LOST.
    bool is_degraded = false;
    bool is_lost = false;
  };

  InputStamps stamps;
  std::optional<Odometry> odometry;
  std::optional<ObstacleMap> map;
  double max_forward_mps = 0.0;   ///< speed bound of the pitch controller
  bool laser_is_held = false;     ///< it does not nod
  bool servo_is_stalled = false;  ///< the one that pitches the laser
  std::int64_t sweep_count = 0;   ///< reversals of the head
  MapPose pose;
  std::optional<GoalInMap> goal;
  bool is_goal_void = false;  ///< its map, or without 2D SLAM its odom frame, is gone
  std::optional<std::string> stopped_by;
  const Geofence* geofence = nullptr;  ///< null: none
  const Map2d* map_2d = nullptr;       ///< in the frame map; null: not used
  /// 2D SLAM was restarted, so its map frame may no longer be the one in which the geofence was
  /// given.
  bool is_fence_void = false;

  /// Takes the goal of a GOAL message; empty if it cancels the goal.
  void take_goal(const std::optional<GoalInMap>& new_goal);

  /// Corrects the pose. Returns whether it puts the robot elsewhere in map.
  [[nodiscard]] bool correct_pose(const geometry::SE2& T_map_odom);

  /// Forgets what belongs to the former odom frame.
  void forget_odom_frame();

  /// The map frame is a new one from now on: goal and geofence could be anywhere in it.
  void forget_map_frame();

  /// Needs odometry and map.
  [[nodiscard]] Situation situation(const DriveParams& drive) const;

  [[nodiscard]] GoalState goal_state() const;
  /// Of the goal's message; 0 without a goal.
  [[nodiscard]] std::int64_t goal_utime() const { return goal ? goal->utime : 0; }

  /// Base in the frame map. Needs odometry.
  [[nodiscard]] geometry::SE2 T_map_base() const { return pose.T_map_odom * odometry->T_odom_base; }

 private:
  [[nodiscard]] bool may_be_at_goal() const;
  [[nodiscard]] double permitted_mps(const DriveParams& drive) const;
};

}  // namespace nodmap::navigator
