// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/robust_kernel.hpp"

#include <gtest/gtest.h>

namespace nodmap::registration {
namespace robust_kernel_test {

TEST(RobustKernel, TheWeightIsOneAtZeroAndAQuarterAtTheScale) {
  EXPECT_EQ(geman_mcclure(0.0), 1.0);
  EXPECT_EQ(geman_mcclure(1.0), 0.25);
  EXPECT_EQ(geman_mcclure(3.0F), 0.0625F);
}

// With a scale of 2 standard deviations of 0.5, a deviation of 1 is at the scale.
TEST(RobustKernel, TheInformationOfWhatIsContradictedVanishes) {
  EXPECT_EQ(robust_information(0.0, 0.5, 2.0), 4.0);
  EXPECT_EQ(robust_information(-1.0, 0.5, 2.0), 1.0);
  EXPECT_LT(robust_information(100.0, 0.5, 2.0), 1e-6);
}

}  // namespace robust_kernel_test
}  // namespace nodmap::registration
