// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/odometry_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nodmap::slam6d {
namespace odometry_scatter_test {

constexpr double kLeast = 0.1;
constexpr double kSigmaM = 0.06;  // of a motion, by the parameters

// The evidence of a motion that was `error_m` longer than predicted. The standard deviation of the
// measurement is `measured_m` and that of the prediction `kSigmaM`; the estimate is their weighted
// mean.
MotionEvidence evidence(double error_m, double measured_m) {
  const double prior = kSigmaM * kSigmaM;
  const double gain = prior / (prior + measured_m * measured_m);
  return {.deviation = gain * error_m,
          .prior_variance = prior,
          .posterior_variance = (1.0 - gain) * prior};
}

double learned(double scatter, int motions, double measured_m) {
  OdometryScatter learner(kLeast);
  std::mt19937 random(1);
  std::normal_distribution<double> error(0.0, scatter * kSigmaM);
  for (int i = 0; i < motions; ++i) {
    learner.learn(evidence(error(random), measured_m), kSigmaM * kSigmaM);
  }
  return learner.factor();
}

// The standard deviation of some 40 errors is known to 1 / sqrt(2 * 40) = 11 %. The tolerance is
// twice that.
TEST(OdometryScatter, LearnsTheScatterOfTheWheelsWithinItsLimits) {
  EXPECT_DOUBLE_EQ(OdometryScatter(kLeast).factor(), 1.0);
  EXPECT_NEAR(learned(0.3, 300, 0.005), 0.3, 0.22 * 0.3);
  EXPECT_NEAR(learned(0.6, 300, 0.005), 0.6, 0.22 * 0.6);
  EXPECT_DOUBLE_EQ(learned(0.01, 300, 0.005), kLeast);
  EXPECT_DOUBLE_EQ(learned(3.0, 300, 0.005), 1.0);
}

// A less exact measurement counts less, and one that does not improve the prediction does not
// count.
TEST(OdometryScatter, LearnsLessFromImpreciseMeasurements) {
  EXPECT_GT(learned(0.1, 10, 0.06), learned(0.1, 10, 0.005) + 0.05);
  EXPECT_DOUBLE_EQ(learned(0.1, 300, 10.0 * kSigmaM), 1.0);
}

// One slip of 30 cm, which is 5 standard deviations, among 41 motions gives sqrt(25 / 41) = 0.78,
// or a little less, because the measurement does not have its full weight.
TEST(OdometryScatter, RisesAtOnceAfterASlip) {
  OdometryScatter learner(kLeast);
  for (int i = 0; i < 300; ++i) {
    learner.learn(evidence(0.0, 0.005), kSigmaM * kSigmaM);
  }
  EXPECT_DOUBLE_EQ(learner.factor(), kLeast);
  learner.learn(evidence(5.0 * kSigmaM, 0.005), kSigmaM * kSigmaM);
  EXPECT_NEAR(learner.factor(), std::sqrt(25.0 / 41.0), 0.02);
  learner.forget();
  EXPECT_DOUBLE_EQ(learner.factor(), 1.0);
}

TEST(OdometryScatter, WithALowerLimitOfOneNothingIsLearned) {
  OdometryScatter learner(1.0);
  for (int i = 0; i < 300; ++i) {
    learner.learn(evidence(0.0, 0.005), kSigmaM * kSigmaM);
  }
  EXPECT_DOUBLE_EQ(learner.factor(), 1.0);
}

}  // namespace odometry_scatter_test
}  // namespace nodmap::slam6d
