// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/oriented_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace oriented_points_test {

TEST(OrientedPointExtractor, NormalsOfAWallPointToTheScanner) {
  OrientedPointExtractor extractor;
  test::Scanner scanner(0.0);
  const auto points = extractor.extract(scanner.scan({{{2, -1}, {2, 1}}}, {}), {});
  ASSERT_GT(points.size(), 40U);
  for (const OrientedPoint& point : points) {
    ASSERT_TRUE(point.has_normal());
    EXPECT_NEAR(point.p.x(), 2.0, 1e-6);  // ranges are single precision
    EXPECT_NEAR(point.normal.x(), -1.0, 1e-6);
  }
}

TEST(OrientedPointExtractor, PointsAreMovedByThePositionOfTheMount) {
  OrientedPointExtractor extractor;
  test::Scanner scanner(0.0);
  scan::Scan scan = scanner.scan({{{2, -1}, {2, 1}}}, {});
  scan.T_base_mount.translation().x() = -0.04;
  const auto points = extractor.extract(scan, {});
  ASSERT_GT(points.size(), 40U);
  for (const OrientedPoint& point : points) {
    EXPECT_NEAR(point.p.x(), 1.96, 1e-6);
  }
}

// Each beam is measured from the pose at its own time. The robot rotates to the left at 180 deg/s;
// half a mirror revolution of a SICK takes 6.67 ms.
TEST(OrientedPointExtractor, DeskewsAScan) {
  const test::FloorPlan wall{{{2, -6}, {2, 6}}};
  const geometry::SE2 T_first_last{0.01, 0.0, geometry::deg_to_rad(1.2)};
  test::Scanner scanner(0.0);
  scan::Scan scan = scanner.scan(wall, {});
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const double part = scan.fraction(beam);
    const geometry::SE2 T_first_beam{part * T_first_last.x, 0.0, part * T_first_last.yaw};
    scan.ranges_m[beam] = scanner.scan(wall, T_first_beam).ranges_m[beam];
  }
  OrientedPointExtractor extractor;
  double worst_m = 0.0;
  for (const OrientedPoint& point : extractor.extract(scan, {})) {
    worst_m = std::max(worst_m, std::abs(point.p.x() - 2.0));
  }
  EXPECT_GT(worst_m, 0.05);  // not deskewed: at 6 m to the side, 1.2 degrees are 12 cm
  for (const OrientedPoint& point : extractor.extract(scan, T_first_last)) {
    EXPECT_NEAR(point.p.x(), 2.0, 1e-5);  // ranges are single precision
    ASSERT_TRUE(!point.has_normal() || std::abs(point.normal.x() + 1.0) < 1e-5);
  }
}

TEST(OrientedPointExtractor, APointBetweenTwoRangeJumpsHasNoNormal) {
  const std::vector<Eigen::Vector2d> points{{5, -0.1}, {2, 0}, {5, 0.1}, {5, 0.2}, {5, 0.3}};
  EXPECT_TRUE(estimate_normal(points, 1, {0, 0}).isZero(0.0));
  EXPECT_TRUE(estimate_normal(points, 0, {0, 0}).isZero(0.0));
  EXPECT_NEAR(estimate_normal(points, 3, {0, 0}).x(), -1.0, 1e-12);
}

TEST(OrientedPointExtractor, ReadingsWithoutAnEchoGiveNoPoint) {
  OrientedPointExtractor extractor;
  test::Scanner scanner;
  scan::Scan scan = scanner.scan({}, {});
  EXPECT_TRUE(extractor.extract(scan, {}).empty());
  scan.ranges_m.assign(181, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(extractor.extract(scan, {}).empty());
  scan.ranges_m.clear();
  EXPECT_TRUE(extractor.extract(scan, {}).empty());
}

}  // namespace oriented_points_test
}  // namespace nodmap::slam2d
