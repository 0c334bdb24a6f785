// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/geometry/angle.hpp"
#include "common/geometry/se2.hpp"
#include "common/geometry/se3.hpp"

namespace nodmap::geometry {
namespace geometry_test {

// A few roundings of doubles of magnitude 10.
constexpr double kRounding = 1e-12;

TEST(Angle, NormalizesIntoHalfOpenInterval) {
  EXPECT_DOUBLE_EQ(normalize_angle(0.0), 0.0);
  EXPECT_DOUBLE_EQ(normalize_angle(kPi), kPi);
  EXPECT_DOUBLE_EQ(normalize_angle(-kPi), kPi);
  EXPECT_NEAR(normalize_angle(3 * kPi / 2), -kPi / 2, kRounding);
  EXPECT_NEAR(normalize_angle(-7.0), -7.0 + 2 * kPi, kRounding);
}

TEST(Angle, NormalizesToTheIEEERemainder) {
  for (int i = -4000; i <= 4000; ++i) {
    const double angle_rad = 0.0031 * i;
    const double remainder_rad = std::remainder(angle_rad, 2 * kPi);
    EXPECT_EQ(normalize_angle(angle_rad), remainder_rad);
  }
  const double nearly_pi = std::nextafter(kPi, 0.0);
  EXPECT_EQ(normalize_angle(nearly_pi), nearly_pi);
  EXPECT_EQ(normalize_angle(-nearly_pi), -nearly_pi);
  EXPECT_TRUE(std::isnan(normalize_angle(std::numeric_limits<double>::quiet_NaN())));
}

TEST(Angle, DifferenceIsTheShortestTurn) {
  EXPECT_NEAR(angle_difference(deg_to_rad(-179), deg_to_rad(179)), deg_to_rad(2), kRounding);
  EXPECT_NEAR(angle_difference(deg_to_rad(179), deg_to_rad(-179)), deg_to_rad(-2), kRounding);
}

TEST(Se2, InverseUndoesAndChainsAssociate) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-3.0, 3.0);
  for (int i = 0; i < 1000; ++i) {
    const SE2 a{value(random), value(random), value(random)};
    const SE2 b{value(random), value(random), value(random)};
    const Eigen::Vector2d p(value(random), value(random));
    EXPECT_LT(((a.inverse() * a) * p - p).norm(), kRounding);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), kRounding);
    EXPECT_LT((to_se3(a) * Eigen::Vector3d(p.x(), p.y(), 0) -
               Eigen::Vector3d((a * p).x(), (a * p).y(), 0))
                  .norm(),
              kRounding);
  }
}

TEST(Se2, LeftTurnMovesWhatIsAheadToTheLeftInTheMap) {
  const SE2 T_map_base{1.0, 2.0, kPi / 2};
  const Eigen::Vector2d ahead(1.0, 0.0);
  EXPECT_NEAR((T_map_base * ahead).x(), 1.0, kRounding);
  EXPECT_NEAR((T_map_base * ahead).y(), 3.0, kRounding);
}

TEST(Se3, PositivePitchLooksUp) {
  const Eigen::Vector3d forward = pitch_rotation(deg_to_rad(30)) * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(forward.x(), std::cos(deg_to_rad(30)), kRounding);
  EXPECT_NEAR(forward.z(), 0.5, kRounding);
  EXPECT_NEAR(pitch_rotation(1.0).determinant(), 1.0, kRounding);
}

TEST(Se3, InterpolatesEndsMiddleAndBeyond) {
  const SE3 from = to_se3(SE2{1, 0, 0.2});
  const SE3 to = to_se3(SE2{3, 2, 1.0});
  EXPECT_TRUE(interpolate(from, to, 0.0).isApprox(from, kRounding));
  EXPECT_TRUE(interpolate(from, to, 1.0).isApprox(to, kRounding));
  const SE2 middle = to_se2(interpolate(from, to, 0.5));
  EXPECT_NEAR(middle.x, 2.0, kRounding);
  EXPECT_NEAR(middle.y, 1.0, kRounding);
  EXPECT_NEAR(middle.yaw, 0.6, kRounding);
  EXPECT_NEAR(to_se2(interpolate(from, to, 1.5)).yaw, 1.4, kRounding);
}

TEST(Se3, PlanarRoundTrip) {
  const SE2 pose{1.5, -2.5, -3.0};
  const SE2 back = to_se2(to_se3(pose));
  EXPECT_NEAR(back.x, pose.x, kRounding);
  EXPECT_NEAR(back.y, pose.y, kRounding);
  EXPECT_NEAR(back.yaw, pose.yaw, kRounding);
  EXPECT_NEAR(rotation_angle(to_se3(pose)), 3.0, kRounding);
}

// The shorter way round: from 3 to -3 rad it is across the rear.
TEST(Se3, DistanceAndRotationBetweenPosesAreThoseInThePlane) {
  const SE2 a{1.0, 2.0, 3.0};
  const SE2 b{4.0, -2.0, -3.0};
  EXPECT_NEAR(distance_m(a, b), 5.0, kRounding);
  EXPECT_NEAR(rotation_rad(a, b), 2.0 * kPi - 6.0, kRounding);
  EXPECT_NEAR(distance_m(to_se3(a), to_se3(b)), 5.0, kRounding);
  EXPECT_NEAR(rotation_rad(to_se3(a), to_se3(b)), 2.0 * kPi - 6.0, kRounding);
}

TEST(Se3, ASkewMatrixIsTheCrossProduct) {
  const Eigen::Vector3d v(1.0, -2.0, 3.0);
  const Eigen::Vector3d w(0.5, 4.0, -1.0);
  EXPECT_TRUE((skew(v) * w).isApprox(v.cross(w), kRounding));
}

}  // namespace geometry_test
}  // namespace nodmap::geometry
