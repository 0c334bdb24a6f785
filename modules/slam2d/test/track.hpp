// SPDX-License-Identifier: BSD-3-Clause
// Drives 2D SLAM scan by scan.
#pragma once

#include <optional>

#include "modules/slam2d/scan/level_scan_input.hpp"
#include "modules/slam2d/slam2d.hpp"

namespace nodmap::slam2d::test {

inline constexpr time::Duration kPeriod = 200ms;  // of level scans

/// 2D SLAM with the input of its scans.
struct Slam : Slam2d {
  explicit Slam(const Slam2dParams& params = {}) : Slam2d(params), input(params.level_scans) {}
  LevelScanInput input;
};

/// Adds a scan together with odometry of the same time. Returns the pose that was found, if any.
inline std::optional<PoseUpdate> track(Slam& slam, const scan::Scan& scan,
                                       const geometry::SE2& T_odom_base) {
  slam.input.add_odometry(scan.stamp, geometry::to_se3(T_odom_base));
  slam.input.add_scan(scan);
  const std::optional<LevelScan> level_scan = slam.input.next();
  return level_scan ? slam.add_scan(*level_scan) : std::nullopt;
}

}  // namespace nodmap::slam2d::test
