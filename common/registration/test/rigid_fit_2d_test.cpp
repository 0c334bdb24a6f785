// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/rigid_fit_2d.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace nodmap::registration {
namespace rigid_fit_2d_test {

using geometry::SE2;

// Metres and radians. Double precision resolves 1e-14 m in coordinates of tens of metres;
// requirement R33 asks for 1e-9.
constexpr double kExact = 1e-9;

void expect_near(const SE2& a, const SE2& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(geometry::angle_difference(a.yaw, b.yaw), 0.0, tolerance);
}

double eq3(const std::vector<Eigen::Vector2d>& model, const std::vector<Eigen::Vector2d>& data,
           const SE2& T) {
  double sum = 0.0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    sum += (model[i] - T * data[i]).squaredNorm();
  }
  return sum;
}

TEST(RigidFit2d, R33_RecoversRandomTransforms) {
  std::mt19937 random(33);
  std::uniform_real_distribution<double> coordinate(-20.0, 20.0);
  std::uniform_real_distribution<double> angle(-geometry::kPi, geometry::kPi);
  for (int cloud = 0; cloud < 200; ++cloud) {
    const SE2 truth{coordinate(random), coordinate(random), angle(random)};
    RigidFit2d fit(truth.translation());
    for (int i = 0; i < 2 + cloud; ++i) {
      const Eigen::Vector2d data(coordinate(random), coordinate(random));
      fit.add(truth * data, data, 0.1 + 0.01 * i);
    }
    const auto solution = fit.solve();
    ASSERT_TRUE(solution);
    expect_near(*solution, truth, kExact);
  }
}

TEST(RigidFit2d, R33_IsTheMinimumOfEquation3) {
  std::mt19937 random(34);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::vector<Eigen::Vector2d> model;
  std::vector<Eigen::Vector2d> data;
  RigidFit2d fit;
  for (int i = 0; i < 50; ++i) {
    data.emplace_back(5.0 * noise(random), 5.0 * noise(random));
    model.push_back(SE2{1.0, -2.0, 0.7} * data.back() +
                    Eigen::Vector2d(noise(random), noise(random)));
    fit.add(model.back(), data.back());
  }
  const SE2 best = fit.solve().value();
  const double least = eq3(model, data, best);
  // A step of 1e-3 raises the sum of 50 squares by some 1e-5: far above rounding.
  for (const SE2& aside : {SE2{1e-3, 0, 0}, SE2{-1e-3, 0, 0}, SE2{0, 1e-3, 0}, SE2{0, -1e-3, 0},
                           SE2{0, 0, 1e-3}, SE2{0, 0, -1e-3}}) {
    EXPECT_GT(eq3(model, data, {best.x + aside.x, best.y + aside.y, best.yaw + aside.yaw}), least);
  }
}

// Eigen's implementation knows no weights, so it is compared with weights of 1.
TEST(RigidFit2d, R33_AgreesWithUmeyamaOnNoisyCorrespondences) {
  std::mt19937 random(35);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::uniform_real_distribution<double> coordinate(-20.0, 20.0);
  std::uniform_real_distribution<double> angle(-geometry::kPi, geometry::kPi);
  for (int cloud = 0; cloud < 100; ++cloud) {
    const SE2 truth{coordinate(random), coordinate(random), angle(random)};
    Eigen::Matrix2Xd model(2, 30);
    Eigen::Matrix2Xd data(2, 30);
    RigidFit2d fit(truth.translation());
    for (Eigen::Index i = 0; i < data.cols(); ++i) {
      data.col(i) << coordinate(random), coordinate(random);
      model.col(i) =
          truth * Eigen::Vector2d(data.col(i)) + Eigen::Vector2d(noise(random), noise(random));
      fit.add(model.col(i), data.col(i));
    }
    const Eigen::Matrix3d expected = Eigen::umeyama(data, model, false);
    expect_near(fit.solve().value(),
                {expected(0, 2), expected(1, 2), std::atan2(expected(1, 0), expected(0, 0))},
                kExact);
  }
}

TEST(RigidFit2d, R33_MirroredPointsStillGiveARotation) {
  // The model is a cross and the data its mirror image. A reflection would fit exactly, but is not
  // a rigid motion. The best rotation, computed by hand, is the identity.
  RigidFit2d fit;
  fit.add({1, 0}, {1, 0});
  fit.add({-1, 0}, {-1, 0});
  fit.add({0, 0.5}, {0, -0.5});
  fit.add({0, -0.5}, {0, 0.5});
  const auto solution = fit.solve();
  ASSERT_TRUE(solution);
  expect_near(*solution, {}, kExact);
}

TEST(RigidFit2d, R33_PointsOnALineAreEnoughInThePlane) {
  const SE2 truth{0.5, -0.25, 2.0};
  RigidFit2d fit;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector2d data(i, 2.0 * i);
    fit.add(truth * data, data);
  }
  const auto solution = fit.solve();
  ASSERT_TRUE(solution);
  expect_near(*solution, truth, kExact);
}

TEST(RigidFit2d, R33_DegenerateInputGivesNoFit) {
  RigidFit2d nothing;
  EXPECT_FALSE(nothing.solve());
  nothing.add({1, 2}, {3, 4});
  EXPECT_FALSE(nothing.solve());

  RigidFit2d one_place;
  for (int i = 0; i < 4; ++i) {
    one_place.add({i, i}, {0.1, 0.2});
  }
  EXPECT_FALSE(one_place.solve());
}

TEST(RigidFit2d, IgnoresCorrespondencesWithoutWeightOrNotFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const SE2 truth{1.0, 2.0, 0.3};
  RigidFit2d fit;
  for (const Eigen::Vector2d& data : {Eigen::Vector2d(0, 0), Eigen::Vector2d(2, 1)}) {
    fit.add(truth * data, data);
  }
  fit.add({kNan, 0.0}, {0.0, 0.0});
  fit.add({0.0, 0.0}, {0.0, std::numeric_limits<double>::infinity()});
  fit.add({50.0, 50.0}, {0.0, 0.0}, 0.0);
  fit.add({50.0, 50.0}, {0.0, 0.0}, -1.0);
  fit.add({50.0, 50.0}, {0.0, 0.0}, kNan);
  expect_near(fit.solve().value(), truth, kExact);
}

}  // namespace rigid_fit_2d_test
}  // namespace nodmap::registration
