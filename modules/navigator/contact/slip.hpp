// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::navigator {

/// Detects that the wheels rotate but the robot does not move, because it pushes against something
/// that no beam shows, such as glass. Compares odometry with the pose of 2D SLAM over the last
/// second, or the last two intervals between poses if they are longer.
///
/// Why these limits: the wheels must count 12 cm, because scan matching errs by 2 to 3 cm. Odometry
/// must count three times the true distance, which neither a scale error of 3 % nor braking on a
/// smooth floor comes near. A correction of the pose by 2D SLAM does, but in one interval only: the
/// others must show the slip as well.
class SlipMonitor {
 public:
  /// Takes a pose that 2D SLAM is sure of, and odometry of the same time. If the wheels have
  /// rotated without moving the robot, returns base in odom before that; the comparison then begins
  /// anew.
  [[nodiscard]] std::optional<geometry::SE2> update(time::Timestamp stamp,
                                                    const geometry::SE2& T_odom_base,
                                                    const geometry::SE2& T_map_base);

  void reset() { poses_.clear(); }

 private:
  struct Pose {
    time::Timestamp stamp{};
    geometry::SE2 T_odom_base;
    Eigen::Vector2d p_map;
  };
  [[nodiscard]] bool is_slip() const;

  std::deque<Pose> poses_;
};

}  // namespace nodmap::navigator
