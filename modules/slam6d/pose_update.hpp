// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam6d/keyframe.hpp"
#include "modules/slam6d/registration.hpp"

namespace nodmap::slam6d {

/// The robot's pose in the middle of one sweep, and how it was found.
struct PoseUpdate {
  time::Timestamp stamp{};  ///< of the base pose
  geometry::SE3 T_odom_base = geometry::SE3::Identity();
  /// The odom frame of `T_odom_base` in the first one: identity until odometry begins anew.
  geometry::SE3 T_first_odom = geometry::SE3::Identity();
  geometry::SE3 T_map_base = geometry::SE3::Identity();  ///< as known when the sweep was complete
  /// The correction of odometry as known at the sweep's last beam, for what comes after it.
  geometry::SE3 T_map_odom = geometry::SE3::Identity();
  /// Of the base's position (m) and rotation vector (rad), axes of map: of the match where the map
  /// tells the pose, else of odometry since then. Zero for the first sweep, which is the map.
  Matrix6d covariance = Matrix6d::Zero();
  /// False while a robot that was put into a known map has not been found in it: then the poses
  /// mean nothing.
  bool is_place_known = true;
  std::size_t scans_used = 0;
  std::size_t scans_without_pose = 0;
  std::size_t num_points = 0;
  bool is_stationary = false;  ///< the robot, during the whole sweep
  /// From the last keyframe's base pose to this one (0 for the first).
  double distance_m = 0.0;
  double rotation_rad = 0.0;
  /// Empty: too thin a sweep, which follows odometry, or the first, which is the map.
  std::optional<Registration> registration = std::nullopt;
  std::optional<KeyframeReason> keyframe = std::nullopt;  ///< empty: not kept

  /// Whether the map tells this pose, not odometry alone.
  [[nodiscard]] bool is_tracked() const {
    return registration ? registration->is_accepted() : keyframe == KeyframeReason::kFirst;
  }
};

}  // namespace nodmap::slam6d
