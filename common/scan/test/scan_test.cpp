// SPDX-License-Identifier: BSD-3-Clause
#include "common/scan/scan.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace nodmap::scan {
namespace scan_test {

using geometry::deg_to_rad;

Scan sick_scan(double pitch_first_deg, double pitch_last_deg) {
  Scan scan;
  scan.angle_first_rad = deg_to_rad(-90);
  scan.angle_step_rad = deg_to_rad(1);
  scan.pitch_first_rad = deg_to_rad(pitch_first_deg);
  scan.pitch_last_rad = deg_to_rad(pitch_last_deg);
  scan.range_min_m = 0.05;
  scan.range_max_m = 32.0;
  scan.T_base_mount.translation() = Eigen::Vector3d(0.15, 0.0, 0.38);
  scan.ranges_m.assign(181, 2.0F);
  return scan;
}

// R4: compares Eq. 1 with an independent computation, the beam's unit vector rotated by an
// axis-angle rotation, for random ranges, yaws and pitches. 1e-9 is the requirement's tolerance.
TEST(Scan, R4_Equation1EqualsAxisAngle) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> range(0.1, 30.0);
  std::uniform_real_distribution<double> yaw(-geometry::kPi, geometry::kPi);
  std::uniform_real_distribution<double> pitch(-1.5, 1.5);
  for (int i = 0; i < 100'000; ++i) {
    Scan scan = sick_scan(0, 0);
    scan.angle_first_rad = yaw(random);
    scan.pitch_first_rad = scan.pitch_last_rad = pitch(random);
    scan.ranges_m.assign(1, 1.0F);
    const double d = range(random);
    const Eigen::AngleAxisd about_right_axis(scan.pitch_first_rad, -Eigen::Vector3d::UnitY());
    const Eigen::Vector3d beam =
        d * Eigen::Vector3d(std::cos(scan.angle_first_rad), std::sin(scan.angle_first_rad), 0);
    const Eigen::Vector3d expected = about_right_axis * beam + Eigen::Vector3d(0.15, 0, 0.38);
    ASSERT_LT((point_in_base(scan, 0, d) - expected).norm(), 1e-9);
  }
}

// R4 and R5 by hand. The paper's axes are x right, z ahead, y up; ours x ahead, y left, z up. Its
// yaw 90 (ahead) is our 0, its yaw 0 (right) our -90.
TEST(Scan, R4_R5_HandCases) {
  Scan scan = sick_scan(0, 0);
  scan.T_base_mount = geometry::SE3::Identity();
  const auto expect_point = [&](std::size_t beam, const Eigen::Vector3d& expected) {
    EXPECT_LT((point_in_base(scan, beam, 2.0) - expected).norm(), 1e-12) << "beam " << beam;
  };
  expect_point(90, {2, 0, 0});   // straight ahead
  expect_point(0, {0, -2, 0});   // to the right: negative y
  expect_point(180, {0, 2, 0});  // to the left: positive y
  scan.pitch_first_rad = scan.pitch_last_rad = deg_to_rad(30);
  expect_point(90, {2 * std::cos(deg_to_rad(30)), 0, 1.0});  // looks up
  expect_point(0, {0, -2, 0});  // the beam along the pitch axis does not move with the pitch
}

TEST(Scan, ProjectorEqualsPointByPointWithPitchInterpolatedPerBeam) {
  Scan scan = sick_scan(-10, -8);
  scan.mirror_offset_m = Eigen::Vector3d(0.08, 0.0, 0.02);
  scan.T_base_mount.linear() =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  ScanProjector projector;
  const auto points = projector.hits(scan);
  ASSERT_EQ(points.size(), 181U);
  for (const auto& point : points) {
    EXPECT_LT((point.p_base - point_in_base(scan, point.beam, 2.0)).norm(), 1e-12);
  }
  EXPECT_NEAR(scan.pitch_rad(0), deg_to_rad(-10), 1e-15);
  EXPECT_NEAR(scan.pitch_rad(90), deg_to_rad(-9), 1e-15);
  EXPECT_NEAR(scan.pitch_rad(180), deg_to_rad(-8), 1e-15);
}

TEST(Scan, ProjectorSkipsBeamsWithoutAHit) {
  Scan scan = sick_scan(0, 0);
  scan.ranges_m = {1.0F,
                   std::numeric_limits<float>::quiet_NaN(),
                   std::numeric_limits<float>::infinity(),
                   -1.0F,
                   0.01F,
                   33.0F,
                   2.0F};
  ScanProjector projector;
  const auto points = projector.hits(scan);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].beam, 0U);
  EXPECT_EQ(points[1].beam, 6U);
}

TEST(Scan, EmptyAndSingleBeam) {
  Scan scan = sick_scan(5, 7);
  ScanProjector projector;
  scan.ranges_m.clear();
  EXPECT_TRUE(projector.hits(scan).empty());
  scan.ranges_m = {1.0F};
  ASSERT_EQ(projector.hits(scan).size(), 1U);
  EXPECT_DOUBLE_EQ(scan.pitch_rad(0), deg_to_rad(5));
}

TEST(Scan, PlausibilityRefusesNonsense) {
  EXPECT_TRUE(is_plausible(sick_scan(0, 0)));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scan scan = sick_scan(nan, 0);
  EXPECT_FALSE(is_plausible(scan));
  scan = sick_scan(0, 0);
  scan.angle_step_rad = 0.0;
  EXPECT_FALSE(is_plausible(scan));
  scan = sick_scan(0, 0);
  scan.range_max_m = scan.range_min_m;
  EXPECT_FALSE(is_plausible(scan));
  scan = sick_scan(0, 0);
  scan.duration = -1us;
  EXPECT_FALSE(is_plausible(scan));
  scan = sick_scan(0, 0);
  scan.T_base_mount.translation().y() = -11.0;
  EXPECT_FALSE(is_plausible(scan));
  scan = sick_scan(0, 0);
  scan.mirror_offset_m.x() = 11.0;
  EXPECT_FALSE(is_plausible(scan));
}

}  // namespace scan_test
}  // namespace nodmap::scan
