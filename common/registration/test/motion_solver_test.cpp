// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/motion_solver.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace nodmap::registration {
namespace motion_solver_test {

using Vector3 = Eigen::Matrix<double, 3, 1>;
using Matrix3 = Eigen::Matrix<double, 3, 3>;

Information<3> evidence(const Vector3& mean, const Vector3& sigma) {
  Information<3> information;
  information.H = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  information.b = information.H * mean;
  return information;
}

// The closed form for two normal distributions of one number: the mean weighted by inverse
// variance.
TEST(MotionSolver, WeightsMeasurementAndPriorByInverseVariance) {
  const auto estimate =
      solve_motion(evidence({1.0, 2.0, 3.0}, {0.1, 0.2, 1.0}), Matrix3(Matrix3::Zero()),
                   evidence({0.0, 0.0, 0.0}, {0.1, 0.1, 0.5}));
  ASSERT_TRUE(estimate.is_valid);
  EXPECT_NEAR(estimate.x[0], 0.5, 1e-12);
  EXPECT_NEAR(estimate.x[1], 2.0 / 5.0, 1e-12);
  EXPECT_NEAR(estimate.x[2], 3.0 / 5.0, 1e-12);
  EXPECT_NEAR(estimate.covariance(1, 1), 1.0 / (1.0 / 0.04 + 1.0 / 0.01), 1e-12);
}

// Along a direction without information the result is the prior's; along the others it is the
// measurement's.
TEST(MotionSolver, ADegenerateDirectionKeepsThePrior) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 20; ++run) {
    Vector3 open(normal(random), normal(random), normal(random));
    open.normalize();
    Information<3> measurement;
    for (int i = 0; i < 50; ++i) {
      Vector3 row(normal(random), normal(random), normal(random));
      row -= row.dot(open) * open;
      measurement.H += 1e6 * row * row.transpose();
    }
    const Vector3 truth = Vector3(1.0, 2.0, 3.0) - Vector3(1.0, 2.0, 3.0).dot(open) * open;
    measurement.b = measurement.H * truth;
    const Vector3 prior_mean = truth + 0.3 * open;
    const auto estimate =
        solve_motion(measurement, Matrix3(Matrix3::Zero()), evidence(prior_mean, {0.1, 0.1, 0.1}));
    ASSERT_TRUE(estimate.is_valid);
    // Rounding of a system whose condition number is about 1e6.
    EXPECT_LT((estimate.x - prior_mean).norm(), 1e-8);
    EXPECT_NEAR(open.dot(estimate.covariance * open), 0.01, 1e-6);
  }
}

// In x all of the measurement's information is imitated, so that only the prior is left. In y it is
// half of it, in z none.
TEST(MotionSolver, SubtractsImitatedInformation) {
  const Information<3> measurement = evidence({1.0, 1.0, 1.0}, {0.1, 0.1, 0.1});
  Matrix3 imitated = Matrix3::Zero();
  imitated(0, 0) = 100.0;
  imitated(1, 1) = 50.0;
  const auto estimate =
      solve_motion(measurement, imitated, evidence(Vector3::Zero(), {0.1, 0.1, 0.5}));
  ASSERT_TRUE(estimate.is_valid);
  EXPECT_NEAR(estimate.x[0], 0.0, 1e-12);
  EXPECT_NEAR(estimate.covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(estimate.x[1], 50.0 / (50.0 + 100.0), 1e-12);
  EXPECT_NEAR(estimate.x[2], 100.0 / (100.0 + 4.0), 1e-12);
}

TEST(MotionSolver, InputThatIsNotFiniteOrWithoutPriorIsInvalid) {
  Information<3> measurement = evidence(Vector3::Ones(), Vector3::Ones());
  EXPECT_FALSE(solve_motion(measurement, Matrix3(Matrix3::Zero()), Information<3>{}).is_valid);
  measurement.b[0] = std::numeric_limits<double>::quiet_NaN();
  const auto estimate = solve_motion(measurement, Matrix3(Matrix3::Zero()),
                                     evidence(Vector3::Zero(), Vector3::Ones()));
  EXPECT_FALSE(estimate.is_valid);
  EXPECT_EQ(estimate.x, Vector3::Zero());
}

}  // namespace motion_solver_test
}  // namespace nodmap::registration
