// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::slam2d {

/// How far a pose can be trusted, by how it was found. POSE_2D calls kOdometry DEGRADED as well.
enum class PoseState : std::uint8_t {
  kTracking = 0,  ///< by matching, in all directions
  kDegraded = 1,  ///< by matching; degenerate directions, or the place, by odometry
  kOdometry = 2,  ///< by odometry: the scan has too few points, or shows only what is new
  kLost = 3,      ///< by odometry, in doubt: the scan contradicts the map
};

/// Level scans with a pose.
struct ScansByState {
  std::int64_t all = 0;  ///< the sum of the next four
  std::int64_t tracked = 0;
  std::int64_t degraded = 0;
  std::int64_t by_odometry = 0;
  std::int64_t lost = 0;

  void count(PoseState state) {
    ++all;
    tracked += state == PoseState::kTracking ? 1 : 0;
    degraded += state == PoseState::kDegraded ? 1 : 0;
    by_odometry += state == PoseState::kOdometry ? 1 : 0;
    lost += state == PoseState::kLost ? 1 : 0;
  }
};

/// Searches for the robot.
struct SearchCounts {
  std::int64_t made = 0;
  std::int64_t found = 0;  ///< that found it

  SearchCounts& operator+=(const SearchCounts& other) {
    made += other.made;
    found += other.found;
    return *this;
  }
};

/// The robot's pose at the first beam of a level scan.
struct PoseUpdate {
  time::Timestamp stamp{};  ///< of the first beam
  geometry::SE2 T_map_base = {};
  /// The correction of odometry, which itself never jumps. For odom see LevelScan::T_odom_base.
  geometry::SE2 T_map_odom = {};
  double inlier_ratio = 0.0;  ///< of the match, like the next two; 0 without a match
  double score = 0.0;
  double rms_m = 0.0;
  /// Of T_map_base: position (m) and heading (rad) of base in the axes of map. Zero where it is not
  /// known: the robot is lost.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  PoseState state = PoseState::kOdometry;
  bool is_keyframe = false;

  /// Whether the pose was found by matching.
  [[nodiscard]] bool is_matched() const { return state <= PoseState::kDegraded; }
};

}  // namespace nodmap::slam2d
