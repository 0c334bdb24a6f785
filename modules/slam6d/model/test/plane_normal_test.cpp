// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/plane_normal.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <random>

namespace nodmap::slam6d {
namespace plane_normal_test {

// The covariance of points around a voxel: a plane, a clump or something in between.
Eigen::Matrix3f random_covariance(std::mt19937& random) {
  std::normal_distribution<float> coordinate(0.0F, 0.1F);
  std::uniform_real_distribution<float> thickness(0.0F, 1.0F);
  const float flat = thickness(random);
  const Eigen::Matrix3f axes = Eigen::Matrix3f::NullaryExpr([&] { return coordinate(random); });
  Eigen::Matrix3f second = Eigen::Matrix3f::Zero();
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3f p =
        axes * Eigen::Vector3f(coordinate(random), coordinate(random), flat * coordinate(random));
    second += p * p.transpose();
  }
  return second / 12.0F;
}

// The oracle: Eigen's solver, whose arithmetic is the same.
TEST(PlaneNormal, EqualsTheSmallestEigenvectorToTheLastBit) {
  std::mt19937 random(1);
  int num_planes = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Matrix3f covariance = random_covariance(random);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
    solver.computeDirect(covariance);
    const bool is_thin = solver.eigenvalues()[0] < 0.1F * solver.eigenvalues()[1];
    const auto normal = plane_normal(covariance, 0.1F);
    ASSERT_EQ(normal.has_value(), is_thin) << covariance;
    if (normal) {
      ASSERT_EQ(*normal, solver.eigenvectors().col(0)) << covariance;
      ++num_planes;
    }
  }
  EXPECT_GT(num_planes, 2'000);
  EXPECT_LT(num_planes, 18'000);
}

TEST(PlaneNormal, PointsAtOnePlaceOrAllAroundHaveNone) {
  EXPECT_FALSE(plane_normal(Eigen::Matrix3f::Zero(), 0.1F));
  EXPECT_FALSE(plane_normal(Eigen::Matrix3f::Identity(), 0.1F));
}

// Rounding decides which of the many planes through a line is found, if any. It must be a number.
TEST(PlaneNormal, PointsOnALineHaveAUnitVectorOrNone) {
  std::mt19937 random(2);
  std::normal_distribution<float> coordinate;
  for (int i = 0; i < 1'000; ++i) {
    const Eigen::Vector3f along(i % 3 == 0 ? 0.0F : coordinate(random),
                                i % 2 == 0 ? 0.0F : coordinate(random), coordinate(random));
    if (const auto normal = plane_normal(along * along.transpose(), 0.1F)) {
      EXPECT_NEAR(normal->norm(), 1.0F, 1e-5F);  // some roundings
    }
  }
}

}  // namespace plane_normal_test
}  // namespace nodmap::slam6d
