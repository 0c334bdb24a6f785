// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"
#include "modules/slam6d/registration/registration.hpp"

namespace nodmap::slam6d {

/// Why the map keeps a sweep.
enum class KeyframeReason : std::uint8_t { kFirst, kInterruption, kDistance, kRotation };

/// The robot's pose in the middle of one sweep, and how it was found.
struct PoseUpdate {
  time::Timestamp stamp{};  ///< of the base pose
  geometry::SE3 T_odom_base = geometry::SE3::Identity();
  /// The odom frame of `T_odom_base`, in the first odom frame: identity until odometry restarts.
  geometry::SE3 T_first_odom = geometry::SE3::Identity();
  geometry::SE3 T_map_base = geometry::SE3::Identity();  ///< as known when the sweep was complete
  /// The correction of odometry as known at the sweep's last beam, for what comes after it.
  geometry::SE3 T_map_odom = geometry::SE3::Identity();
  /// Covariance of the position of base (m) and its rotation vector (rad), axes of map: that of the
  /// match where the map determines the pose, otherwise that of odometry since the last match. Zero
  /// for the first sweep, which is the map.
  Matrix6d covariance = Matrix6d::Zero();
  /// False while the robot has not been found in a saved map: until then the poses have no meaning.
  bool is_place_known = true;
  std::size_t scans_used = 0;
  std::size_t num_points = 0;
  bool is_stationary = false;  ///< the robot, during the whole sweep
  /// From the last keyframe's base pose to this one (0 for the first).
  double distance_m = 0.0;
  double rotation_rad = 0.0;
  /// Empty for a sweep that is too thin and follows odometry, and for the first, which is the map.
  std::optional<Registration> registration = std::nullopt;
  std::optional<KeyframeReason> keyframe = std::nullopt;  ///< empty: not kept
  /// The map began again with the first sweep: all keyframes are others than before.
  bool begins_anew = false;

  /// Whether the map determines this pose, not odometry alone.
  [[nodiscard]] bool is_tracked() const {
    return registration ? registration->is_accepted() : keyframe == KeyframeReason::kFirst;
  }
  /// Whether the wheels slipped.
  [[nodiscard]] bool is_slipped() const { return registration && registration->is_slipped; }
};

}  // namespace nodmap::slam6d
