// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/whole_steps.hpp"

#include <gtest/gtest.h>

namespace nodmap::geometry {
namespace whole_steps_test {

TEST(WholeSteps, AMultipleCountsInFull) {
  for (const double step : {0.01, 0.025, 0.05, 0.1, 0.2, 0.3}) {
    for (int steps = 0; steps < 1000; ++steps) {
      // Written as a decimal number, as parameters are: it need not be the rounded product.
      const double length = static_cast<double>(steps * std::lround(1000.0 * step)) / 1000.0;
      EXPECT_EQ(whole_steps(length, step), steps) << step;
    }
  }
}

TEST(WholeSteps, APartOfAStepDoesNotCount) {
  EXPECT_EQ(whole_steps(0.049, 0.05), 0);
  EXPECT_EQ(whole_steps(0.3, 0.2), 1);
  EXPECT_EQ(whole_steps(0.299, 0.05), 5);
}

}  // namespace whole_steps_test
}  // namespace nodmap::geometry
