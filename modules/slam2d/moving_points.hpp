// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "modules/slam2d/level_scan.hpp"
#include "modules/slam2d/view.hpp"

namespace nodmap::slam2d {

/// Tells what moves: points of a scan that lie where an earlier keyframe, from nearly the same
/// place, saw free space. People who walk through the view of the robot are neither to shape its
/// pose nor to enter the map.
///
/// A scan is compared with the last keyframe and, for what comes slowly, with the oldest one near.
/// Not noticed: what walks straight away from the robot, or comes out from behind something.
class MovingPointFilter {
 public:
  /// The next keyframe to compare with: all of its points.
  void add_keyframe(const LevelScan& scan);

  /// The points of a scan without those that moved there, valid until the next call. If few are
  /// left, people stand around the robot, or it is the robot that is elsewhere.
  [[nodiscard]] std::span<const OrientedPoint> stationary(const LevelScan& scan);

  /// Whether the last keyframe and a scan, placed by odometry, cannot both be right: more than a
  /// quarter of what one of them measured lies where the other saw free space. A scan that shows
  /// only what was never in view contradicts nothing.
  [[nodiscard]] bool contradicts(const LevelScan& scan) const;

  /// Odometry continues in another frame.
  void change_odometry_frame(const geometry::SE2& T_old_new);

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
