// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/mixed_pixel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "common/geometry/angle.hpp"
#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace mixed_pixel_test {

scan::Scan scan_of(std::vector<float> ranges_m) {
  scan::Scan scan;
  scan.angle_step_rad = geometry::deg_to_rad(1.0);
  scan.range_min_m = 0.05;
  scan.range_max_m = 8.0;
  scan.ranges_m = std::move(ranges_m);
  return scan;
}

std::vector<std::size_t> mixed_pixels(const scan::Scan& scan) {
  std::vector<std::size_t> beams;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (is_mixed_pixel(scan, i)) {
      beams.push_back(i);
    }
  }
  return beams;
}

using Beams = std::vector<std::size_t>;

TEST(MixedPixel, IsASingleBeamBetweenTwoSurfaces) {
  EXPECT_EQ(mixed_pixels(scan_of({1, 1, 1, 1.5, 2, 2, 2})), Beams{3});
  EXPECT_EQ(mixed_pixels(scan_of({2, 2, 2, 1.1F, 1, 1, 1})), Beams{3});
}

// The end of a wall, seen from the side and so close that the spot is as wide as two beams.
TEST(MixedPixel, NearTheSensorTwoBeamsSideBySideAreMixed) {
  EXPECT_EQ(mixed_pixels(scan_of({1.45F, 1.43F, 1.45F, 0.78F, 0.43F, 0.29F, 0.29F, 0.28F})),
            (Beams{3, 4}));
  EXPECT_EQ(mixed_pixels(scan_of({0.33F, 0.32F, 0.33F, 0.46F, 0.73F, 0.91F, 0.9F, 0.86F})),
            (Beams{3, 4}));
}

// A wall 5 cm beside the sensor, farther away than the spot is wide, begins a metre ahead.
TEST(MixedPixel, BeamsThatGrazeAWallAreNotMixed) {
  std::vector<float> ranges_m(3, 4.0F);
  for (double degree = 1.0; degree < 3.0; degree += 0.5) {
    ranges_m.push_back(static_cast<float>(0.05 / std::sin(geometry::deg_to_rad(degree))));
  }
  ranges_m.insert(ranges_m.end(), 3, 4.0F);
  scan::Scan scan = scan_of(ranges_m);
  scan.angle_step_rad = geometry::deg_to_rad(0.5);
  EXPECT_EQ(mixed_pixels(scan), Beams{});
}

TEST(MixedPixel, BeamsOnASurfaceAreNotMixed) {
  EXPECT_EQ(mixed_pixels(scan_of({1, 1, 1, 2, 2, 2})), Beams{}) << "an edge";
  EXPECT_EQ(mixed_pixels(scan_of({2, 2, 2, 1, 2, 2, 2})), Beams{}) << "a post, one beam wide";
  EXPECT_EQ(mixed_pixels(scan_of({1, 1, 1, 1.5, 1.5, 2, 2})), Beams{}) << "two beams wide";
  EXPECT_EQ(mixed_pixels(scan_of({1, 1, 1, 1.05F, 2, 2, 2})), Beams{}) << "within the noise";
}

TEST(MixedPixel, ABeamWithoutMeasuredNeighboursIsNotMixed) {
  const float none = std::numeric_limits<float>::infinity();
  const float bad = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(mixed_pixels(scan_of({})), Beams{});
  EXPECT_EQ(mixed_pixels(scan_of({1.0F})), Beams{});
  EXPECT_EQ(mixed_pixels(scan_of({1, 1.5, none})), Beams{});
  EXPECT_EQ(mixed_pixels(scan_of({bad, 1.5, 2})), Beams{});
  EXPECT_EQ(mixed_pixels(scan_of({1, none, 2})), Beams{});
}

// A plane at any distance, hit from head on to grazing, with the laser's noise of 1 cm: no beam
// counts as a mixed pixel.
TEST(MixedPixel, NoBeamOnAPlaneIsMixedAtAnyAngle) {
  std::mt19937 engine(1);
  std::normal_distribution<double> noise_m(0.0, 0.01);
  int beams = 0;
  for (double distance_m = 0.1; distance_m < 2.0; distance_m += 0.05) {
    std::vector<float> ranges_m;
    for (int degree = 3; degree <= 177; ++degree) {
      const double range_m = distance_m / std::sin(geometry::deg_to_rad(degree));
      ranges_m.push_back(static_cast<float>(range_m + noise_m(engine)));
    }
    beams += static_cast<int>(ranges_m.size());
    EXPECT_EQ(mixed_pixels(scan_of(ranges_m)), Beams{}) << distance_m;
  }
  EXPECT_GT(beams, 6000);
}

// A wall ends before a farther wall; each scan has a mixed pixel where the near one ends.
TEST(MixedPixel, AMixedPixelIsNotAnObstacle) {
  const test::Ground walls{{{{1.0, -2.0}, {1.1, 0.0}, 0.5}, {{2.0, -2.0}, {2.1, 2.0}, 0.5}}};
  LocalMap map({}, {});
  int mixed = 0;
  for (double y = -0.3; y < 0.3; y += 0.02) {
    const geometry::SE2 T_odom_base{0.0, y, 0.0};
    scan::Scan scan = test::scan_of(walls, T_odom_base, 0.0);
    for (std::size_t i = 1; i < scan.ranges_m.size(); ++i) {
      if (std::abs(scan.ranges_m[i] - scan.ranges_m[i - 1]) > 0.5F) {
        scan.ranges_m[i] = 0.5F * (scan.ranges_m[i] + scan.ranges_m[i - 1]);
        ++mixed;
        break;
      }
    }
    map.add_scan(scan, T_odom_base);
  }
  EXPECT_GT(mixed, 20);
  for (const Eigen::Vector2d& p : map.points_base({}, 2.5)) {
    EXPECT_TRUE(p.x() < 1.15 || p.x() > 1.95) << p.transpose();
  }
}

}  // namespace mixed_pixel_test
}  // namespace nodmap::navigator
