// SPDX-License-Identifier: BSD-3-Clause
// For the tests of both maps in complete scenes: a nodding scanner in a ray-cast world.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>

#include "modules/map_server/map_server.hpp"
#include "modules/map_server/test/world.hpp"

namespace nodmap::map_server::test {

inline MapServerParams with_rule(RemovalRule rule) {
  MapServerParams params;
  params.update.rule = rule;
  return params;
}

inline bool has_point_near(const EgoMap& map, const Eigen::Vector2d& p_base, double radius_m) {
  return std::ranges::any_of(map.scan().points(), [&](const EgoPoint& p) {
    return p.valid && (p.p_base - p_base).norm() < radius_m;
  });
}

inline void stay(MapServer& server, NoddingScanner& scanner, const World& world, int scans) {
  for (int i = 0; i < scans; ++i) {
    ASSERT_EQ(server.add_scan(scanner.scan(world, {}), geometry::SE3::Identity()),
              ScanStatus::kUsed);
  }
}

/// Drives ahead at a speed, with exact odometry, and calls back after each scan.
inline void drive(MapServer& server, NoddingScanner& scanner, const World& world, double speed_mps,
                  double duration_s, const std::function<void(const SE2&)>& after_each) {
  for (int i = 0; i * NoddingScanner::kPeriodS < duration_s; ++i) {
    const double t = i * NoddingScanner::kPeriodS;
    const SE2 pose{speed_mps * t, 0.0, 0.0};
    server.add_scan(scanner.scan(world, pose), geometry::to_se3(pose));
    after_each(pose);
  }
}

/// Distance of a place inside room() to the nearest of its four walls.
inline double off_walls_m(const Eigen::Vector2d& p, double x0, double x1, double y0, double y1) {
  return std::min(
      {std::abs(p.x() - x0), std::abs(p.x() - x1), std::abs(p.y() - y0), std::abs(p.y() - y1)});
}

}  // namespace nodmap::map_server::test
