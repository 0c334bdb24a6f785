// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/pose_edges.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <vector>

#include "common/registration/test/moved.hpp"

namespace nodmap::registration {
namespace pose_edges_test {

using geometry::SE2;
using geometry::SE3;
using test::moved;

// Central differences over 2e-6 m, of functions with a curvature of a few per metre.
constexpr double kDifferences = 1e-6;

// Sets T to one of three poses in general position.
void put(std::size_t i, SE2& T) {
  const SE2 poses[] = {{2.0, -1.0, 0.7}, {-0.5, 3.0, -1.9}, {3.0, 7.0, 2.0}};
  T = poses[i];
}
void put(std::size_t i, SE3& T) {
  SE2 flat;
  put(i, flat);
  const Eigen::Vector3d rotations[] = {{0.1, -0.2, 0.7}, {0.3, 0.1, -1.9}, {-0.2, 0.4, 2.0}};
  T.linear() = geometry::rotation_of(rotations[i]);
  T.translation() << flat.x, flat.y, 0.5 - static_cast<double>(i);
}

template <class Pose>
Pose pose(std::size_t i) {
  Pose T = PoseSpace<Pose>::identity();
  put(i, T);
  return T;
}

PoseVector<SE2> motion_between(const SE2& from, const SE2& to) {
  return {to.x - from.x, to.y - from.y, geometry::angle_difference(to.yaw, from.yaw)};
}
PoseVector<SE3> motion_between(const SE3& from, const SE3& to) {
  PoseVector<SE3> motion;
  motion << to.translation() - from.translation(),
      geometry::rotation_vector(to.linear() * from.linear().transpose());
  return motion;
}

Eigen::Matrix3d in_map(const Eigen::Matrix3d& matrix, const SE2& T_map_own) {
  return rotated(matrix, T_map_own.yaw);
}
Matrix6d in_map(const Matrix6d& matrix, const SE3& T_map_own) {
  return rotated(matrix, T_map_own.linear());
}

// Variances of a translation and of a rotation in each direction.
template <class Pose>
PoseMatrix<Pose> information(double variance_m2, double variance_rad2) {
  constexpr int kTranslations = PoseSpace<Pose>::kDimensions == 3 ? 2 : 3;
  PoseVector<Pose> variance = PoseVector<Pose>::Constant(variance_rad2);
  variance.template head<kTranslations>().setConstant(variance_m2);
  return variance.cwiseInverse().asDiagonal();
}

template <class Pose>
class PoseEdges : public testing::Test {
 protected:
  static constexpr int kDimensions = PoseSpace<Pose>::kDimensions;
  using Matrix = PoseMatrix<Pose>;
  using Vector = PoseVector<Pose>;

  // Without symmetry: all directions are correlated.
  static Matrix some_information(double scale) {
    Matrix root = Matrix::Zero();
    for (int row = 0; row < kDimensions; ++row) {
      root(row, row) = 10.0 + 5.0 * row;
      for (int column = row + 1; column < kDimensions; ++column) {
        root(row, column) = 2.0 - 3.0 * row + column;
      }
    }
    return scale * root * root.transpose();
  }

  static PoseEdge<Pose> edge(std::size_t from, std::size_t to, const Pose& T_from_to,
                             double scale = 1.0) {
    return {.from = from, .to = to, .T_from_to = T_from_to, .information = some_information(scale)};
  }

  // The numeric derivative of the pose that `function` returns, by small motions of its argument.
  static Matrix jacobian(const Pose& at, const std::function<Pose(const Pose&)>& function) {
    constexpr double kStep = 1e-6;
    Matrix J;
    for (int column = 0; column < kDimensions; ++column) {
      const Vector step = kStep * Vector::Unit(column);
      J.col(column) =
          motion_between(function(moved(at, -step)), function(moved(at, step))) / (2.0 * kStep);
    }
    return J;
  }
};
using Spaces = testing::Types<SE2, SE3>;
TYPED_TEST_SUITE(PoseEdges, Spaces);

TYPED_TEST(PoseEdges, AReversedEdgeHasTheCovarianceOfTheInversePose) {
  using Pose = TypeParam;
  const auto first = pose<Pose>(0);
  const PoseEdge<Pose> there = this->edge(3, 5, first);
  const PoseEdge<Pose> back = reversed(there);
  EXPECT_EQ(back.from, 5U);
  EXPECT_EQ(back.to, 3U);
  const auto J = this->jacobian(first, [](const Pose& T) { return T.inverse(); });
  EXPECT_TRUE(inverse(back.information)
                  .isApprox(J * inverse(there.information) * J.transpose(), kDifferences));
}

TYPED_TEST(PoseEdges, AComposedEdgeHasTheSumOfBothCovariances) {
  using Pose = TypeParam;
  const auto first = pose<Pose>(0);
  const auto second = pose<Pose>(1);
  const PoseEdge<Pose> a_b = this->edge(0, 1, first);
  const PoseEdge<Pose> b_c = this->edge(1, 2, second, 0.3);
  const PoseEdge<Pose> a_c = composed(a_b, b_c);
  EXPECT_EQ(a_c.from, 0U);
  EXPECT_EQ(a_c.to, 2U);
  const auto J_a = this->jacobian(first, [&](const Pose& T) { return T * second; });
  const auto J_b = this->jacobian(second, [&](const Pose& T) { return first * T; });
  EXPECT_TRUE(inverse(a_c.information)
                  .isApprox(J_a * inverse(a_b.information) * J_a.transpose() +
                                J_b * inverse(b_c.information) * J_b.transpose(),
                            kDifferences));
}

// Edges along corridors, in which the position along the corridor is unknown, are composed and
// reversed again and again. That direction stays unknown, and every result has a valid covariance.
TYPED_TEST(PoseEdges, AnUnknownDirectionStaysUnknown) {
  using Pose = TypeParam;
  PoseEdge<Pose> sum{.from = 0, .to = 1, .T_from_to = pose<Pose>(0)};
  sum.information = information<Pose>(1.0 / 4e4, 1e-6);
  sum.information(0, 0) = 0.0;
  const PoseEdge<Pose> step = sum;
  for (int i = 0; i < 100; ++i) {
    sum = reversed(composed(sum, step));
    const auto values = eigensystem(sum.information).values;
    // Rounding of eigenvalues up to 1e6.
    ASSERT_GT(values[0], -1e-9);
    ASSERT_LT(values[0], 1e-4);
    ASSERT_TRUE(covariance_of(sum.information).allFinite());
    ASSERT_GT(covariance_of(sum.information).diagonal().minCoeff(), 0.0);
  }
}

// Errors of 10 cm everywhere against errors of 1.7 degrees, which move a point 5 m away by 15 cm.
TYPED_TEST(PoseEdges, TheSurerEdgeIsTheOneThatPlacesAPointFiveMetresAwayBetter) {
  using Pose = TypeParam;
  PoseEdge<Pose> by_position;
  PoseEdge<Pose> by_rotation;
  by_position.information = information<Pose>(0.1 * 0.1, 1e-8);
  by_rotation.information = information<Pose>(1e-8, 0.03 * 0.03);
  EXPECT_TRUE(is_surer(by_position, by_rotation));
  EXPECT_FALSE(is_surer(by_rotation, by_position));
}

// The orientation of an edge is uncertain, too. Seen from its other end that moves the far node
// aside.
TYPED_TEST(PoseEdges, ACovarianceIsThatOfTheMostCertainPath) {
  using Pose = TypeParam;
  const std::vector<Pose> poses{pose<Pose>(0), pose<Pose>(1), pose<Pose>(2), pose<Pose>(0)};
  const PoseEdge<Pose> first = this->edge(0, 1, poses[0].inverse() * poses[1]);
  const PoseEdge<Pose> second = this->edge(1, 2, poses[1].inverse() * poses[2], 0.3);
  const PoseEdge<Pose> direct = this->edge(0, 2, poses[0].inverse() * poses[2], 0.01);
  const std::vector<PoseEdge<Pose>> edges{first, second, direct};
  // covariance_of() adds 1e-6 to an information of at least some tens.
  constexpr double kRounding = 1e-6;
  const auto from_first = covariances_from<Pose>(0, poses, edges);
  const auto is_that_of = [&](const auto& found, const PoseEdge<Pose>& path) {
    return found.isApprox(in_map(inverse(path.information), poses[path.from]), kRounding);
  };
  EXPECT_TRUE(from_first[0].isZero(0.0));
  EXPECT_TRUE(is_that_of(from_first[1], first));
  EXPECT_TRUE(is_that_of(from_first[2], composed(first, second)));
  EXPECT_EQ(from_first[3](0, 0), 1e6);  // no edge leads there
  const auto from_last = covariances_from<Pose>(2, poses, edges);
  EXPECT_TRUE(is_that_of(from_last[1], reversed(second)));
  EXPECT_TRUE(is_that_of(from_last[0], reversed(composed(first, second))));
}

TYPED_TEST(PoseEdges, WhatCanBeAnInformationMatrix) {
  using Information = PoseMatrix<TypeParam>;
  const Information valid = TestFixture::some_information(100.0);
  const auto changed = [&](int row, int column, double value) {
    Information matrix = valid;
    matrix(row, column) = value;
    return matrix;
  };
  EXPECT_TRUE(is_information(valid));
  EXPECT_TRUE(is_information(Information(Information::Zero())));
  Information one_direction = Information::Zero();
  one_direction(0, 0) = 1.0;
  EXPECT_TRUE(is_information(one_direction));
  EXPECT_FALSE(is_information(changed(0, 0, -1.0)));
  EXPECT_FALSE(is_information(changed(0, 1, 2.0 * valid(0, 1) + 1.0)));
  EXPECT_FALSE(is_information(changed(0, 0, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_FALSE(is_information(changed(0, 0, std::numeric_limits<double>::infinity())));
  Information correlated = Information::Identity();
  correlated(0, 1) = correlated(1, 0) = 2.0;
  EXPECT_FALSE(is_information(correlated));
}

// Of ten straight steps of 1 m, only the heading is uncertain. Seen from the first node, the
// heading of step k moves the last one by what is still to come, 10 - k metres; seen from the last
// node, it moves the first one by what lies behind, k metres.
TYPED_TEST(PoseEdges, AnUncertainHeadingMovesTheFarEndOfAPathAside) {
  using Pose = TypeParam;
  constexpr double kHeadingRad2 = 1e-4;
  constexpr double kPositionM2 = 1e-8;
  std::vector<Pose> poses(11, PoseSpace<Pose>::identity());
  std::vector<PoseEdge<Pose>> edges;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    poses[k] = moved(poses[k - 1], PoseVector<Pose>::Unit(0));
    edges.push_back({.from = k - 1,
                     .to = k,
                     .T_from_to = poses[k - 1].inverse() * poses[k],
                     .information = information<Pose>(kPositionM2, kHeadingRad2)});
  }
  EXPECT_NEAR(covariances_from<Pose>(0, poses, edges).back()(1, 1),
              285.0 * kHeadingRad2 + 10.0 * kPositionM2, 1e-9);
  EXPECT_NEAR(covariances_from<Pose>(10, poses, edges).front()(1, 1),
              385.0 * kHeadingRad2 + 10.0 * kPositionM2, 1e-9);
}

}  // namespace pose_edges_test
}  // namespace nodmap::registration
