// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::navigator {

/// Detects that the wheels turn but the robot does not move, because it pushes against something
/// that no beam shows, such as glass. Odometry is compared with the pose of 2D SLAM over the last
/// second.
///
/// Why these limits: below 12 cm in a second the errors of scan matching, 2 to 3 cm, are too large
/// compared with the distance. Odometry that counts 3 % too much, or slips on a smooth floor while
/// braking, is far from counting three times the distance.
class SlipMonitor {
 public:
  /// Takes a pose that 2D SLAM is sure of, and odometry at the same time. Returns true if the
  /// wheels have turned without moving the robot; the comparison then begins again.
  [[nodiscard]] bool update(time::Timestamp stamp, const geometry::SE2& T_odom_base,
                            const geometry::SE2& T_map_base);

  void reset() { poses_.clear(); }

 private:
  struct Pose {
    time::Timestamp stamp{};
    Eigen::Vector2d p_odom;
    Eigen::Vector2d p_map;
  };
  std::deque<Pose> poses_;  // of the last second
};

}  // namespace nodmap::navigator
