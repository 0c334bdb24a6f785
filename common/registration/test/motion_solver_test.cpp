// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/motion_solver.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "common/registration/dense_solvers.hpp"

namespace nodmap::registration {
namespace motion_solver_test {

Information<6> evidence(const Vector6d& mean, const Vector6d& sigma) {
  Information<6> information;
  information.H = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  information.b = information.H * mean;
  return information;
}

const Matrix6d kNothingImitated = Matrix6d::Zero();

// The closed form for two normal distributions of one number: the mean weighted by inverse
// variance.
TEST(MotionSolver, WeightsMeasurementAndPriorByInverseVariance) {
  const auto estimate =
      solve_motion(evidence({1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, {0.1, 0.2, 1.0, 0.1, 0.1, 0.1}),
                   kNothingImitated, evidence(Vector6d::Zero(), {0.1, 0.1, 0.5, 0.1, 0.1, 0.1}));
  ASSERT_TRUE(estimate.is_valid);
  EXPECT_NEAR(estimate.x[0], 0.5, 1e-12);
  EXPECT_NEAR(estimate.x[1], 2.0 / 5.0, 1e-12);
  EXPECT_NEAR(estimate.x[2], 3.0 / 5.0, 1e-12);
  EXPECT_NEAR(estimate.x[5], 3.0, 1e-12);
  EXPECT_NEAR(estimate.covariance(1, 1), 1.0 / (1.0 / 0.04 + 1.0 / 0.01), 1e-12);
}

// Along a direction without information the result is the prior's; along the others it is the
// measurement's.
TEST(MotionSolver, ADegenerateDirectionKeepsThePrior) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto any_vector = [&] {
    return Vector6d{normal(random), normal(random), normal(random),
                    normal(random), normal(random), normal(random)};
  };
  for (int run = 0; run < 20; ++run) {
    const Vector6d open = any_vector().normalized();
    Information<6> measurement;
    for (int i = 0; i < 50; ++i) {
      Vector6d row = any_vector();
      row -= row.dot(open) * open;
      measurement.H += 1e6 * row * row.transpose();
    }
    Vector6d truth{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
    truth -= truth.dot(open) * open;
    measurement.b = measurement.H * truth;
    const Vector6d prior_mean = truth + 0.3 * open;
    const auto estimate =
        solve_motion(measurement, kNothingImitated, evidence(prior_mean, 0.1 * Vector6d::Ones()));
    ASSERT_TRUE(estimate.is_valid);
    // Rounding of a system whose condition number is about 1e6.
    EXPECT_LT((estimate.x - prior_mean).norm(), 1e-8);
    EXPECT_NEAR(open.dot(estimate.covariance * open), 0.01, 1e-6);
  }
}

// In x all of the measurement's information is imitated, so that only the prior is left. In y it is
// half of it, in the others none.
TEST(MotionSolver, SubtractsImitatedInformation) {
  const Information<6> measurement = evidence(Vector6d::Ones(), 0.1 * Vector6d::Ones());
  Matrix6d imitated = Matrix6d::Zero();
  imitated(0, 0) = 100.0;
  imitated(1, 1) = 50.0;
  const auto estimate = solve_motion(measurement, imitated,
                                     evidence(Vector6d::Zero(), {0.1, 0.1, 0.5, 0.1, 0.1, 0.1}));
  ASSERT_TRUE(estimate.is_valid);
  EXPECT_NEAR(estimate.x[0], 0.0, 1e-12);
  EXPECT_NEAR(estimate.covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(estimate.x[1], 50.0 / (50.0 + 100.0), 1e-12);
  EXPECT_NEAR(estimate.x[2], 100.0 / (100.0 + 4.0), 1e-12);
}

TEST(MotionSolver, InputThatIsNotFiniteOrWithoutPriorIsInvalid) {
  Information<6> measurement = evidence(Vector6d::Ones(), Vector6d::Ones());
  EXPECT_FALSE(solve_motion(measurement, kNothingImitated, Information<6>{}).is_valid);
  measurement.b[0] = std::numeric_limits<double>::quiet_NaN();
  const auto estimate =
      solve_motion(measurement, kNothingImitated, evidence(Vector6d::Zero(), Vector6d::Ones()));
  EXPECT_FALSE(estimate.is_valid);
  EXPECT_EQ(estimate.x, Vector6d::Zero());
}

}  // namespace motion_solver_test
}  // namespace nodmap::registration
