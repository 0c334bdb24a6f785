// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/scan_line.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <tuple>

namespace nodmap::map_server {
namespace scan_line_test {

using geometry::deg_to_rad;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

scan::Scan fan(double pitch_first_deg, double pitch_last_deg, double range_m) {
  scan::Scan scan;
  scan.angle_first_rad = deg_to_rad(-90);
  scan.angle_step_rad = deg_to_rad(1);
  scan.pitch_first_rad = deg_to_rad(pitch_first_deg);
  scan.pitch_last_rad = deg_to_rad(pitch_last_deg);
  scan.range_min_m = 0.05;
  scan.range_max_m = 32.0;
  scan.T_base_mount.translation() = Eigen::Vector3d(0.1, 0.02, 0.38);
  scan.mirror_offset_m = Eigen::Vector3d(0.03, 0.0, 0.05);
  scan.ranges_m.assign(181, static_cast<float>(range_m));
  return scan;
}

// Oracle: Eq. 1. The place below a known point of a known beam must be found on that beam.
TEST(ScanLine, FindsTheBeamOverAPlace) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> pitch(-50.0, 50.0);
  std::uniform_real_distribution<double> range(0.3, 20.0);
  std::uniform_int_distribution<std::size_t> beam(1, 179);
  for (int i = 0; i < 1000; ++i) {
    scan::Scan scan = fan(0, 0, 5.0);
    scan.pitch_first_rad = scan.pitch_last_rad = deg_to_rad(pitch(random));
    scan.T_base_mount.linear() =
        Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 1, 1).normalized()).toRotationMatrix();
    const std::size_t b = beam(random);
    const double r = range(random);
    const Eigen::Vector3d p = scan::point_in_base(scan, b, r);
    const auto crossing = ScanLine(scan).crossing_at(p.head<2>());
    ASSERT_TRUE(crossing);
    // Planes are exact at a constant pitch, 1e-9 is rounding; angles are to 2e-6 rad.
    EXPECT_NEAR(static_cast<double>(crossing->beam) + crossing->between, static_cast<double>(b),
                2e-6 / deg_to_rad(1));
    EXPECT_NEAR(crossing->range_m, r, 1e-9);
    EXPECT_NEAR(crossing->height_m, p.z(), 1e-9);
  }
}

// Between the last and the first beam of a full circle there is no gap.
TEST(ScanLine, AFullCircleHasNoSeam) {
  for (const auto& [first_deg, step_deg, beams] :
       {std::tuple{0.0, 1.0, 360}, std::tuple{-180.0, 1.0, 360}, std::tuple{0.0, -0.5, 720}}) {
    scan::Scan scan = fan(0, 0, 5.0);
    scan.angle_first_rad = deg_to_rad(first_deg);
    scan.angle_step_rad = deg_to_rad(step_deg);
    scan.ranges_m.assign(static_cast<std::size_t>(beams), 5.0F);
    scan.ranges_m.front() = 3.0F;
    const double seam_rad = scan.angle_first_rad - 0.25 * scan.angle_step_rad;
    const Eigen::Vector3d p =
        scan.T_base_mount * (scan.mirror_offset_m + 2.0 * scan::beam_direction(seam_rad, 0.0));
    const ScanLine line(scan);
    const auto crossing = line.crossing_at(p.head<2>());
    ASSERT_TRUE(crossing) << first_deg;
    EXPECT_EQ(crossing->beam, scan.ranges_m.size() - 1);
    EXPECT_EQ(crossing->next, 0U);
    EXPECT_NEAR(crossing->between, 0.75, 1e-3);
    EXPECT_NEAR(crossing->range_m, 2.0, 1e-9);
    EXPECT_NEAR(line.measured_range_m(*crossing).value(), 3.0, 1e-6);  // of the nearer beam
    EXPECT_TRUE(line.both_reach_beyond(*crossing, 2.0));
  }
}

// Angles may be counted from -270 degrees as well.
TEST(ScanLine, AFanThatBeginsBeyondHalfATurnIsTheSame) {
  const scan::Scan same = fan(0, 0, 5.0);
  for (const double turns : {-1.0, 1.0}) {
    scan::Scan scan = same;
    scan.angle_first_rad += turns * deg_to_rad(360);
    for (std::size_t beam = 0; beam < 180; beam += 20) {
      const Eigen::Vector2d p =
          (0.5 * (scan::point_in_base(same, beam, 4.0) + scan::point_in_base(same, beam + 1, 4.0)))
              .head<2>();
      const auto crossing = ScanLine(scan).crossing_at(p);
      ASSERT_TRUE(crossing) << beam;
      EXPECT_EQ(crossing->beam, beam);
    }
  }
}

// While the head nods, the pitch differs from beam to beam.
TEST(ScanLine, FollowsThePitchThroughTheScan) {
  const scan::Scan scan = fan(-11, -10, 5.0);
  for (std::size_t beam = 1; beam < 180; ++beam) {
    const Eigen::Vector3d p = scan::point_in_base(scan, beam, 5.0);
    const auto crossing = ScanLine(scan).crossing_at(p.head<2>());
    ASSERT_TRUE(crossing);
    // A pitch error of one degree would give 8.7 cm. The remaining error is the curvature of tan
    // and the shift of the mirror over half a degree.
    EXPECT_NEAR(crossing->height_m, p.z(), 5e-3) << "beam " << beam;
  }
}

TEST(ScanLine, APlaceOutsideTheFanIsNotSeen) {
  const scan::Scan scan = fan(0, 0, 5.0);
  EXPECT_FALSE(ScanLine(scan).crossing_at({-1.0, 0.5}));
  EXPECT_FALSE(ScanLine(scan).crossing_at({-1.0, -0.5}));
  EXPECT_TRUE(ScanLine(scan).crossing_at({1.0, 0.5}));
}

TEST(ScanLine, HandlesFansThatCountToTheRightOrGoAllAround) {
  const double tolerance = 2e-6 / deg_to_rad(1);  // angles are to 2e-6 rad
  scan::Scan scan = fan(0, 0, 5.0);
  scan.angle_first_rad = deg_to_rad(90);
  scan.angle_step_rad = deg_to_rad(-1);
  const Eigen::Vector3d p = scan::point_in_base(scan, 30, 2.0);
  const auto to_the_right = ScanLine(scan).crossing_at(p.head<2>());
  ASSERT_TRUE(to_the_right);
  EXPECT_NEAR(static_cast<double>(to_the_right->beam) + to_the_right->between, 30, tolerance);
  scan.angle_first_rad = 0.0;
  scan.angle_step_rad = deg_to_rad(1);
  scan.ranges_m.assign(360, 5.0F);
  const Eigen::Vector3d q = scan::point_in_base(scan, 270, 2.0);
  const auto crossing = ScanLine(scan).crossing_at(q.head<2>());
  ASSERT_TRUE(crossing);
  EXPECT_NEAR(static_cast<double>(crossing->beam) + crossing->between, 270, tolerance);
}

TEST(ScanLine, ReachesAsFarAsTheWallBetweenTwoBeams) {
  // A wall at x = 3 m in front of a scanner at the base: every place on it is at the end of a beam.
  scan::Scan scan = fan(0, 0, 0);
  scan.T_base_mount.translation().setZero();
  scan.mirror_offset_m.setZero();
  for (std::size_t i = 0; i < 181; ++i) {
    const double c = std::cos(scan.angle_rad(i));
    scan.ranges_m[i] = c > 0.1 ? static_cast<float>(3.0 / c) : kInfinity;
  }
  for (int i = -214; i < 214; ++i) {
    const double y = 0.07 * i;
    const auto crossing = ScanLine(scan).crossing_at({3.0, y});
    ASSERT_TRUE(crossing);
    const auto reached = ScanLine(scan).measured_range_m(*crossing);
    ASSERT_TRUE(reached);
    // The straight line between two points; the error is that of sin x = x over one degree.
    EXPECT_NEAR(*reached, crossing->range_m, 1e-3) << "y " << y;
    EXPECT_FALSE(ScanLine(scan).both_reach_beyond(*crossing, crossing->range_m + 0.01));
  }
}

TEST(ScanLine, BothBeamsMustReachBeyond) {
  scan::Scan scan = fan(0, 0, 5.0);
  scan.ranges_m[90] = 1.0F;
  const auto beyond = [&](std::size_t beam) {
    return ScanLine(scan).both_reach_beyond({beam, beam + 1, 0.5, 2.0, 0.3}, 2.1);
  };
  EXPECT_FALSE(beyond(89));
  EXPECT_FALSE(beyond(90));
  EXPECT_TRUE(beyond(91));
  // A missing measurement proves nothing.
  scan.ranges_m[90] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(beyond(89));
  scan.ranges_m[90] = 81.83F;  // CARMEN's mark beyond range_max_m
  EXPECT_FALSE(beyond(89));
  scan.ranges_m[90] = kInfinity;  // no echo: free up to range_max_m
  EXPECT_TRUE(beyond(89));
}

TEST(ScanLine, DegenerateScansSeeNothing) {
  scan::Scan scan = fan(90, 90, 5.0);  // straight up: the plane has no height above a point
  EXPECT_FALSE(laser_plane(scan, scan.pitch_first_rad));
  EXPECT_FALSE(ScanLine(scan).crossing_at({1, 0}));
  scan = fan(0, 0, 5.0);
  scan.ranges_m.resize(1);  // one beam cannot have two sides
  EXPECT_FALSE(ScanLine(scan).crossing_at({1, 0}));
  scan.ranges_m.clear();
  EXPECT_FALSE(ScanLine(scan).crossing_at({1, 0}));
  EXPECT_FALSE(ScanLine(fan(0, 0, 5)).crossing_at({std::nan(""), 0}));
}

}  // namespace scan_line_test
}  // namespace nodmap::map_server
