// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/mount_estimate.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::slam6d {
namespace mount_estimate_test {

using geometry::deg_to_rad;
using geometry::rad_to_deg;

// What sweeps of a laser that looks too high show on uneven ground.
MountEstimate learned(double pitch_deg, double ground_deg, int num_sweeps, unsigned seed,
                      const MountParams& params = {}) {
  MountEstimate mount(params);
  std::mt19937 random(seed);
  std::normal_distribution<double> ground(0.0, deg_to_rad(ground_deg));
  for (int i = 0; i < num_sweeps; ++i) {
    mount.learn({deg_to_rad(pitch_deg) + ground(random), ground(random)});
  }
  return mount;
}

TEST(MountEstimate, HalfADegreeIsBelievedAfterTwelveSweeps) {
  // 4 * 1.25 * 0.3 / sqrt(n) degrees: 0.53 for 8 sweeps, 0.43 for 12
  EXPECT_TRUE(learned(0.45, 0.1, 8, 1).error().is_zero());
  // The median of 12 samples is exact to 1.25 * 0.1 / sqrt(12) = 0.036 degrees: three times that.
  EXPECT_NEAR(rad_to_deg(learned(0.5, 0.1, 12, 1).error().pitch_rad), 0.5, 0.11);
  EXPECT_EQ(learned(0.5, 0.1, 12, 1).error().roll_rad, 0.0);
  // 1.25 * 0.1 / sqrt(200) = 0.009 degrees
  EXPECT_NEAR(rad_to_deg(learned(0.5, 0.1, 200, 1).error().pitch_rad), 0.5, 0.027);
}

TEST(MountEstimate, SevenSweepsAreTooFew) {
  EXPECT_TRUE(learned(1.9, 0.0, 7, 1).error().is_zero());
  EXPECT_FALSE(learned(1.9, 0.0, 8, 1).error().is_zero());
}

// Four standard deviations, though looked at after each sweep.
TEST(MountEstimate, UnevenGroundIsNoErrorOfTheMount) {
  for (const double ground_deg : {0.1, 0.3, 0.5, 1.0}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      for (int num_sweeps = 1; num_sweeps <= 60; ++num_sweeps) {
        ASSERT_TRUE(learned(0.0, ground_deg, num_sweeps, seed).error().is_zero())
            << ground_deg << " degrees, seed " << seed;
      }
    }
  }
}

// A ramp right at the start: the first three sweeps see it ahead, the others do not.
TEST(MountEstimate, ARampAtTheStartIsNotBelieved) {
  MountEstimate mount({});
  for (int i = 0; i < 40; ++i) {
    mount.learn({i < 3 ? deg_to_rad(-1.5) : 0.0, 0.0});
    ASSERT_TRUE(mount.error().is_zero()) << i;
  }
}

TEST(MountEstimate, WhatIsTooLargeIsReportedOnly) {
  const MountEstimate mount = learned(2.5, 0.1, 20, 3);
  EXPECT_TRUE(mount.is_too_large());
  EXPECT_TRUE(mount.error().is_zero());
  EXPECT_NEAR(rad_to_deg(mount.believed().pitch_rad), 2.5, 0.1);
}

TEST(MountEstimate, IsNotCorrectedOnRequest) {
  const MountEstimate mount = learned(0.5, 0.1, 20, 4, {.use = false});
  EXPECT_TRUE(mount.error().is_zero());
  EXPECT_FALSE(mount.is_corrected_anew({}));
  EXPECT_NEAR(rad_to_deg(mount.believed().pitch_rad), 0.5, 0.1);
}

TEST(MountEstimate, IsCorrectedAnewOnlyIfItChangesMuch) {
  const MountEstimate mount = learned(0.5, 0.0, 20, 5);
  EXPECT_TRUE(mount.is_corrected_anew({}));
  EXPECT_TRUE(mount.is_corrected_anew({.pitch_rad = deg_to_rad(0.35)}));
  EXPECT_FALSE(mount.is_corrected_anew({.pitch_rad = deg_to_rad(0.45)}));
  EXPECT_TRUE(mount.is_corrected_anew({.pitch_rad = deg_to_rad(0.5), .roll_rad = 0.01}));
}

}  // namespace mount_estimate_test
}  // namespace nodmap::slam6d
