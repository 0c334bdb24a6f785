// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/bend_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/geometry/angle.hpp"

namespace nodmap::slam6d {
namespace bend_sums_test {

using geometry::deg_to_rad;

// Between the knots, and at and beyond both ends.
TEST(BendSums, KnotsAreEvenlySpaced) {
  EXPECT_EQ(knot_at(-1.0).index, 0);
  EXPECT_NEAR(knot_at(-0.8125).fraction, 0.75, 1e-12);
  EXPECT_EQ(knot_at(0.0).index, kBendKnots / 2);
  EXPECT_EQ(knot_at(1.0).index, kBendKnots - 2);
  EXPECT_NEAR(knot_at(1.0).fraction, 1.0, 1e-12);
  EXPECT_EQ(knot_at(7.0).index, kBendKnots - 2);
}

// The heading swings by 0.2 degrees within the sweep. Residuals have a noise of 1 cm at arms of 3
// m.
TEST(BendSums, FindsHowTheHeadingSwings) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> any(-1.0F, 1.0F);
  std::normal_distribution<float> noise_m(0.0F, 0.01F);
  const auto heading_rad = [](double time) { return deg_to_rad(0.2) * std::sin(3.0 * time); };
  BendSums sums;
  for (int i = 0; i < 20000; ++i) {
    const float time = any(random);
    const Eigen::Vector3f moment = 3.0F * Eigen::Vector3f(any(random), any(random), any(random));
    const float residual_m =
        moment.z() * static_cast<float>(heading_rad(static_cast<double>(time))) + noise_m(random);
    sums.add(moment, residual_m, time, 1.0F);
  }
  const Bend bend = sums.solve(1e4, deg_to_rad(0.2));
  // Each knot has the noise of some 2500 residuals of 1 cm, with arms of 1.7 m on average: 0.007
  // degrees. The rest is the swing between two knots.
  for (int k = 0; k < kBendKnots; ++k) {
    EXPECT_NEAR(bend(2, k), heading_rad(0.25 * k - 1.0), deg_to_rad(0.025)) << k;
    EXPECT_NEAR(bend(0, k), 0.0, deg_to_rad(0.025)) << k;
  }
}

// Where nothing was measured a bend is as probable one way as the other.
TEST(BendSums, WithoutMeasurementsThereIsNone) {
  EXPECT_EQ(BendSums{}.solve(1e4, deg_to_rad(0.2)), Bend::Zero());
}

}  // namespace bend_sums_test
}  // namespace nodmap::slam6d
