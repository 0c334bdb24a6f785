// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/variance_factor.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::slam2d {
namespace variance_factor_test {

// Adds loops whose errors have `sigmas` times the assumed standard deviations.
void add_loops(VarianceFactor& factor, int number, double sigmas) {
  std::mt19937 random(1000);
  std::chi_squared_distribution<double> chi_squared(3.0);
  for (int i = 0; i < number; ++i) {
    factor.add(sigmas * sigmas * chi_squared(random));
  }
}

TEST(VarianceFactor, IsOneWithoutLoopsAndWhereLoopsAgreeBetterThanExpected) {
  VarianceFactor factor;
  EXPECT_EQ(factor.value(), 1.0);
  add_loops(factor, 1000, 0.7);
  EXPECT_EQ(factor.value(), 1.0);
}

// The first few loops are too few to tell; a hundred give a mean with a standard error of 8 %.
TEST(VarianceFactor, LearnsHowMuchLargerTheErrorsAre) {
  VarianceFactor factor;
  add_loops(factor, 100, 3.0);
  EXPECT_NEAR(factor.value(), 9.0, 2.5);
}

TEST(VarianceFactor, IsHardlyChangedByOneWrongLoop) {
  VarianceFactor factor;
  factor.add(1e6);
  EXPECT_LT(factor.value(), 2.0);
  add_loops(factor, 100, 0.7);
  EXPECT_EQ(factor.value(), 1.0);
}

}  // namespace variance_factor_test
}  // namespace nodmap::slam2d
