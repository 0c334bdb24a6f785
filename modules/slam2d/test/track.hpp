// SPDX-License-Identifier: BSD-3-Clause
// Drives 2D SLAM scan by scan.
#pragma once

#include <optional>

#include "modules/slam2d/slam2d.hpp"

namespace nodmap::slam2d::test {

inline constexpr time::Duration kPeriod = 200ms;  // of level scans

/// Adds a scan together with odometry of the same time. Returns the pose that was found, if any.
inline std::optional<PoseUpdate> track(Slam2d& slam, const scan::Scan& scan,
                                       const geometry::SE2& T_odom_base) {
  slam.add_odometry(scan.stamp, geometry::to_se3(T_odom_base));
  return slam.add_scan(scan);
}

}  // namespace nodmap::slam2d::test
