// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/walls_behind.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "common/geometry/angle.hpp"
#include "modules/slam2d/test/nodding_scanner.hpp"

namespace nodmap::slam2d {
namespace walls_behind_test {

using Walls = std::vector<std::optional<Eigen::Vector2d>>;

constexpr double kStepM = 0.01;  // from scan to scan

// A robot drives towards a ramp while its laser moves, from 12 degrees by `step_deg` from scan to
// scan. The last of `num_scans` scans is the level one, all of whose points are on slopes.
Walls look_over(const test::Surfaces& surfaces, double step_deg, int num_scans,
                time::Duration period = 13ms) {
  test::NoddingScanner scanner;
  WallsBehind walls_behind;
  scan::Scan level;
  const auto x_at = [&](time::Timestamp stamp) {
    return kStepM * static_cast<double>(stamp.time_since_epoch() / period);
  };
  for (int i = 0; i < num_scans; ++i) {
    const time::Timestamp stamp(period * i);
    level = scanner.scan(surfaces, 12.0 + step_deg * i, geometry::to_se3({x_at(stamp), 0.0, 0.0}));
    level.stamp = stamp;
    walls_behind.add(level);
  }
  const auto place = [&](const scan::Scan& scan) {
    const geometry::SE2 T_level_scan{x_at(scan.stamp) - x_at(level.stamp), 0.0, 0.0};
    return std::optional(SweepScan{scan, T_level_scan, T_level_scan});
  };
  return walls_behind.find(level, std::vector<bool>(level.ranges_m.size(), true), place);
}

int count(const Walls& walls) {
  int count = 0;
  for (const auto& wall : walls) {
    count += wall ? 1 : 0;
  }
  return count;
}

// The ramp of 12 degrees ends at the wall ahead, 5 m from the origin, at a height of 0.87 m.
TEST(WallsBehind, AreSeenOverARamp) {
  test::Surfaces surfaces{{{1, 0, 0}, 5.0}, {{0, 1, 0}, 2.0}, {{0, 1, 0}, -2.0}};
  surfaces.push_back(test::ramp(12.0, 0.9));
  const Walls walls = look_over(surfaces, -1.0, 13);
  for (std::size_t beam = 80; beam <= 100; ++beam) {
    ASSERT_TRUE(walls[beam]) << beam;
    EXPECT_NEAR(walls[beam]->x(), 5.0 - 0.12, 0.03);  // a mean of three readings of 1 cm
  }
}

// Before the last reversal the robot was elsewhere, and may have been tilted.
TEST(WallsBehind, AreNotTakenFromAnotherSweep) {
  EXPECT_EQ(count(look_over(test::hall(), 1.0, 5)), 0);
}

TEST(WallsBehind, AreNotTakenFromLongAgo) {
  EXPECT_EQ(count(look_over(test::hall(), -1.0, 13, 400ms)), 0);
}

// Where the beams meet nothing but a slope there is no wall.
TEST(WallsBehind, ASlopeIsNone) {
  EXPECT_EQ(count(look_over({test::ramp(14.0, 0.9)}, -1.0, 13)), 0);
}

}  // namespace walls_behind_test
}  // namespace nodmap::slam2d
