// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/gyro_bias.hpp"

#include <gtest/gtest.h>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {
namespace gyro_bias_test {

using geometry::deg_to_rad;
using Result = GyroBias::Result;

constexpr double kRate = deg_to_rad(0.4);

// A window of 1 s in four parts, in which the gyro reports this rate; returns what the last says.
Result stand(GyroBias& bias, double rate_rad_s) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(bias.add_still(0.25 * rate_rad_s, 0.25), Result::kNothing);
  }
  return bias.add_still(0.25 * rate_rad_s, 0.25);
}

GyroBias measured(double rate_rad_s) {
  GyroBias bias{GyroParams{}};
  stand(bias, rate_rad_s);
  stand(bias, rate_rad_s);
  return bias;
}

TEST(GyroBias, TwoWindowsInARowMustAgree) {
  GyroBias bias{GyroParams{}};
  EXPECT_EQ(stand(bias, kRate), Result::kNothing);
  EXPECT_EQ(stand(bias, kRate + deg_to_rad(1.0)), Result::kNothing);
  EXPECT_EQ(bias.rate_rad_s(), std::nullopt);
  EXPECT_EQ(stand(bias, kRate + deg_to_rad(1.0)), Result::kMeasured);
  ASSERT_TRUE(bias.rate_rad_s());
  EXPECT_NEAR(*bias.rate_rad_s(), kRate + deg_to_rad(1.0), 1e-12);  // rounding
}

TEST(GyroBias, StandstillsThatAreTooShortAreNotAddedUp) {
  GyroBias bias{GyroParams{}};
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(bias.add_still(0.9 * kRate, 0.9), Result::kNothing);
    bias.end_standstill();
  }
  EXPECT_EQ(bias.rate_rad_s(), std::nullopt);
}

// After a long time the old estimate is worth little: the new one lies between both, and nearer to
// the new window.
TEST(GyroBias, ASmallChangeIsWeighed) {
  GyroBias bias = measured(kRate);
  bias.age(3600.0);
  const double now_rad_s = kRate + deg_to_rad(0.1);
  EXPECT_EQ(stand(bias, now_rad_s), Result::kMeasured);
  EXPECT_GT(*bias.rate_rad_s(), 0.5 * (kRate + now_rad_s));
  EXPECT_LT(*bias.rate_rad_s(), now_rad_s);
}

TEST(GyroBias, ALargeChangeIsTakenAfterFiveWindows) {
  GyroBias bias = measured(kRate);
  const double now_rad_s = kRate + deg_to_rad(2.0);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(stand(bias, now_rad_s), Result::kNothing);
    EXPECT_NEAR(*bias.rate_rad_s(), kRate, 1e-12);  // rounding
  }
  EXPECT_EQ(stand(bias, now_rad_s), Result::kMeasured);
  EXPECT_NEAR(*bias.rate_rad_s(), now_rad_s, 1e-12);  // rounding
}

TEST(GyroBias, OneThatNoIntactGyroHasIsNone) {
  GyroBias bias = measured(kRate);
  const double now_rad_s = GyroParams{}.max_bias_rad_s + deg_to_rad(0.1);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(stand(bias, now_rad_s), Result::kNothing);
  }
  EXPECT_EQ(stand(bias, now_rad_s), Result::kRunsOff);
  EXPECT_EQ(bias.rate_rad_s(), std::nullopt);
}

// The variance of the heading after t is that of an error of the bias times t^2 and, by the walk, a
// third of walk^2 t^3: this is the derivative.
TEST(GyroBias, ItsErrorGrowsWithTheTime) {
  const GyroParams params;
  GyroBias bias = measured(kRate);
  EXPECT_EQ(bias.variance_rad2_per_s(), 0.0);
  bias.age(100.0);
  const double sigma = params.noise_rad;  // of a window of 1 s
  const double walk = params.bias_walk_rad_s;
  EXPECT_NEAR(bias.variance_rad2_per_s(), 200.0 * sigma * sigma + 1e4 * walk * walk, 1e-12);
}

}  // namespace gyro_bias_test
}  // namespace nodmap::kurt
