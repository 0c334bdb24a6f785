// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::navigator {

/// Detects that the wheels rotate but the robot does not move, because it pushes against something
/// that no beam shows, such as glass. Compares odometry with the pose of 2D SLAM over the last
/// second.
///
/// Why these limits: a second must have 12 cm, because scan matching errs by 2 to 3 cm. Odometry
/// must count three times the true distance, which neither a scale error of 3 % nor braking on a
/// smooth floor comes near.
class SlipMonitor {
 public:
  /// Takes a pose that 2D SLAM is sure of, and odometry of the same time. Returns true if the
  /// wheels have rotated without moving the robot; the comparison then begins anew.
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
