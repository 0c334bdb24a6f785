// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "modules/slam2d/scan/level_scan.hpp"
#include "modules/slam2d/scan/view.hpp"

namespace nodmap::slam2d {

/// Finds points that have moved: points of a scan that lie where an earlier keyframe, from nearly
/// the same place, saw free space. People who walk through the view must neither shift the pose nor
/// enter the map.
///
/// A scan is compared with the last keyframe and, to notice slow motion, with the oldest one
/// nearby. What moves straight away from the robot, or appears from behind something, is not
/// noticed.
class MovingPointFilter {
 public:
  /// Adds a keyframe to compare with. `scan` has all of its points.
  void add_keyframe(const LevelScan& scan);

  /// The points of a scan without those that have moved; valid until the next call. If few are
  /// left, either people surround the robot or it is elsewhere.
  [[nodiscard]] std::span<const OrientedPoint> stationary(const LevelScan& scan);

  /// Whether a scan, placed by odometry, contradicts the last keyframe: more than a quarter of the
  /// points of one of them lie where the other saw free space. A scan that shows only what was not
  /// in view before contradicts nothing.
  [[nodiscard]] bool contradicts(const LevelScan& scan) const;

  /// Moves the views into another odom frame, where scans are placed from now on.
  void move_views(const geometry::SE2& T_old_new);

 private:
  struct KeyframeView {
    geometry::SE2 T_odom_base;
    View view;
  };

  [[nodiscard]] const KeyframeView& oldest_near(const geometry::SE2& T_odom_base) const;

  std::deque<KeyframeView> views_;  ///< oldest first
  std::vector<OrientedPoint> stationary_;
};

}  // namespace nodmap::slam2d
