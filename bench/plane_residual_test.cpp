// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plane_residual.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::bench {
namespace plane_residual_test {

using geometry::SE3;

// A board of 2 m x 2 m with a point every 10 cm, 3 m ahead of the scanner, which faces (1, 2, 2)
// / 3.
struct Board {
  Eigen::Vector3d normal = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  Eigen::Vector3d across = normal.unitOrthogonal();
  Eigen::Vector3d up = normal.cross(across);

  [[nodiscard]] std::vector<Eigen::Vector3d> points() const {
    std::vector<Eigen::Vector3d> points;
    for (int i = -10; i <= 10; ++i) {
      for (int k = -10; k <= 10; ++k) {
        points.emplace_back(Eigen::Vector3d(3.0, 0.0, 0.0) + 0.1 * i * across + 0.1 * k * up);
      }
    }
    return points;
  }
};

// Rounding of the eigenvectors of distances of some metres.
constexpr double kRounding = 1e-9;

TEST(PlaneResidual, IsTheDistanceByWhichAPlaneWasMovedAlongItsNormal) {
  const Board board;
  const auto points = board.points();
  for (const double off_m : {0.0, 0.02, -0.3}) {
    SE3 T_model_scan = SE3::Identity();
    T_model_scan.translation() = off_m * board.normal;
    const PlaneResidual found = plane_residual(points, points, T_model_scan);
    EXPECT_EQ(found.num_points, points.size());
    EXPECT_EQ(found.share, 1.0);
    EXPECT_NEAR(found.median_m, std::abs(off_m), kRounding);
    EXPECT_NEAR(found.p90_m, std::abs(off_m), kRounding);
  }
}

// Along the plane nothing is measured: half a step, so that no point is on another.
TEST(PlaneResidual, IsZeroForAMotionWithinThePlane) {
  const Board board;
  SE3 T_model_scan = SE3::Identity();
  T_model_scan.translation() = 0.05 * board.across;
  EXPECT_NEAR(plane_residual(board.points(), board.points(), T_model_scan).p90_m, 0.0, kRounding);
}

// A rotation by a about the board's middle moves points by up to sin(a) times their distance from
// the axis. In the middle half of the distances, uniform from 0 to 1 m, these are 0.5 m: sin(a)
// / 2.
TEST(PlaneResidual, GrowsWithTheDistanceFromTheAxisOfARotation) {
  const Board board;
  constexpr double kAngleRad = 0.01;
  const Eigen::Vector3d middle(3.0, 0.0, 0.0);
  SE3 T_model_scan = SE3::Identity();
  T_model_scan.linear() = Eigen::AngleAxisd(kAngleRad, board.up).toRotationMatrix();
  T_model_scan.translation() = middle - T_model_scan.linear() * middle;
  const PlaneResidual found = plane_residual(board.points(), board.points(), T_model_scan);
  // The rank lies between two of 11 distances, a tenth of a metre apart.
  EXPECT_NEAR(found.median_m, 0.5 * std::sin(kAngleRad), 0.05 * kAngleRad);
}

TEST(PlaneResidual, CountsOnlyPointsNearPlanes) {
  const auto points = Board().points();
  SE3 T_far = SE3::Identity();
  T_far.translation() = 0.51 * Board().normal;
  EXPECT_EQ(plane_residual(points, points, T_far).num_points, 0U);
  // A ball full of points has no planes: of 16 in it, the narrowest direction is never 7 times
  // narrower than the next.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.4, 0.4);
  std::vector<Eigen::Vector3d> ball;
  for (int i = 0; i < 300; ++i) {
    ball.emplace_back(place(random), place(random), place(random));
  }
  EXPECT_EQ(plane_residual(ball, ball, SE3::Identity()).num_points, 0U);
  // 15 points determine no plane by 16, and none at all neither.
  EXPECT_EQ(plane_residual(std::span(points).first(15), points, SE3::Identity()).num_points, 0U);
  EXPECT_EQ(plane_residual({}, points, SE3::Identity()).num_points, 0U);
  EXPECT_EQ(plane_residual(points, {}, SE3::Identity()).share, 0.0);
}

TEST(PlaneResidual, TakesTheMeanOfAVoxelAndLeavesOutWhatIsTooNearOrTooFar) {
  const std::vector<Eigen::Vector3d> points = {
      {1.01, 0.0, 0.0}, {1.03, 0.02, 0.0}, {0.47, 0.0, 0.0}, {30.1, 0.0, 0.0}, {-0.95, 0.0, 0.0}};
  const auto means = voxel_means(points);
  ASSERT_EQ(means.size(), 2U);
  EXPECT_TRUE(means[0].isApprox(Eigen::Vector3d(-0.95, 0.0, 0.0)));
  EXPECT_TRUE(means[1].isApprox(Eigen::Vector3d(1.02, 0.01, 0.0)));
}

}  // namespace plane_residual_test
}  // namespace nodmap::bench
