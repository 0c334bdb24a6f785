// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/area_of_interest.hpp"

#include <gtest/gtest.h>

namespace nodmap::pitch_controller {
namespace {

constexpr PitchInterval kCorridor{-0.3, 0.1};
constexpr PitchInterval kMechanics{-1.0, 0.9};

TEST(AreaOfInterest, R10_EndValuesAreExact) {
  const PitchInterval standing = area_of_interest(0.0, 1.0, kCorridor, kMechanics);
  EXPECT_DOUBLE_EQ(standing.min_rad, -1.0);
  EXPECT_DOUBLE_EQ(standing.max_rad, 0.9);
  for (const double v : {1.0, 1.5, 100.0}) {
    const PitchInterval fast = area_of_interest(v, 1.0, kCorridor, kMechanics);
    EXPECT_EQ(fast.min_rad, -0.3);
    EXPECT_EQ(fast.max_rad, 0.1);
  }
}

TEST(AreaOfInterest, R10_BothEndsCloseAsTheSpeedGrows) {
  PitchInterval before = area_of_interest(0.0, 1.0, kCorridor, kMechanics);
  for (double v = 0.01; v <= 1.0; v += 0.01) {
    const PitchInterval now = area_of_interest(v, 1.0, kCorridor, kMechanics);
    EXPECT_GT(now.min_rad, before.min_rad);
    EXPECT_LT(now.max_rad, before.max_rad);
    before = now;
  }
}

TEST(AreaOfInterest, NeverBeyondTheMechanics) {
  const PitchInterval area = area_of_interest(5.0, 1.0, {-2.0, 2.0}, kMechanics);
  EXPECT_EQ(area.min_rad, -1.0);
  EXPECT_EQ(area.max_rad, 0.9);
}

TEST(AreaOfInterest, BackwardsIsStanding) {
  EXPECT_DOUBLE_EQ(area_of_interest(-0.5, 1.0, kCorridor, kMechanics).min_rad, -1.0);
}

}  // namespace
}  // namespace nodmap::pitch_controller
