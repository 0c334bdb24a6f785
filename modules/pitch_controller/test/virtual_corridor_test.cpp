// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/virtual_corridor.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::pitch_controller {
namespace {

using geometry::rad_to_deg;

TEST(VirtualCorridor, R9_AnglesOfTheReferenceTable) {
  // Seen from the axis, floor to 0.47 m, laser at 0.38 m. The table is given to 0.1 degrees.
  const VirtualCorridor corridor{0.0, 0.47, 0.38, 0.0};
  EXPECT_NEAR(rad_to_deg(corridor.area_from(0.5).min_rad), -37.2, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(0.5).max_rad), 10.2, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(1.0).min_rad), -20.8, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(1.0).max_rad), 5.1, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(1.5).range_rad()), 17.6, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(2.0).range_rad()), 13.3, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(3.0).range_rad()), 8.9, 0.06);
}

TEST(VirtualCorridor, R9_LinesAtTheEndsPassThroughTheCornersOfTheCorridor) {
  const VirtualCorridor corridor = VirtualCorridor::of({});
  for (const double d : {0.1, 0.5, 1.0, 3.0}) {
    const PitchInterval area = corridor.area_from(d);
    // Eq. 1 for a beam straight ahead: at z from the axis it is z tan(pitch) above it. Base: the
    // front is 0.225 m ahead, the axis 0.15 m.
    const double z = d + 0.225 - 0.15;
    EXPECT_NEAR(0.38 + z * std::tan(area.min_rad), 0.05, 1e-12);
    EXPECT_NEAR(0.38 + z * std::tan(area.max_rad), 0.50, 1e-12);
  }
}

TEST(VirtualCorridor, CoveredFromIsTheInverse) {
  const VirtualCorridor corridor = VirtualCorridor::of({});
  for (double d = 0.05; d < 6.0; d += 0.05) {
    EXPECT_NEAR(corridor.covered_from_m(corridor.area_from(d)), d, 1e-9);
  }
}

TEST(VirtualCorridor, TheWorseEndDecides) {
  const VirtualCorridor corridor = VirtualCorridor::of({});
  const PitchInterval one = corridor.area_from(1.0);
  const PitchInterval two = corridor.area_from(2.0);
  EXPECT_NEAR(corridor.covered_from_m({one.min_rad, two.max_rad}), 2.0, 1e-9);
  EXPECT_NEAR(corridor.covered_from_m({two.min_rad, one.max_rad}), 2.0, 1e-9);
}

TEST(VirtualCorridor, PitchesThatNeverCoverIt) {
  const VirtualCorridor corridor = VirtualCorridor::of({});
  EXPECT_TRUE(std::isinf(corridor.covered_from_m({0.0, 0.5})));   // never the bottom
  EXPECT_TRUE(std::isinf(corridor.covered_from_m({-0.5, 0.0})));  // never the top
  EXPECT_TRUE(std::isinf(corridor.covered_from_m({0.1, -0.1})));
  // Beyond straight up and down there is nothing more to gain: from the front on, at once.
  EXPECT_EQ(corridor.covered_from_m({-3.0, 3.0}), 0.0);
}

TEST(VirtualCorridor, ALaserAboveTheCorridorNeedsNoLookUp) {
  const VirtualCorridor corridor{0.05, 0.30, 0.38, 0.0};
  EXPECT_LT(corridor.area_from(1.0).max_rad, 0.0);
  EXPECT_NEAR(corridor.covered_from_m({-0.5, 0.0}), 0.33 / std::tan(0.5), 1e-12);
}

TEST(VirtualCorridor, AFrontBehindTheLaserIsNoDivisionByZero) {
  const VirtualCorridor corridor{0.05, 0.5, 0.38, -0.3};
  EXPECT_TRUE(std::isfinite(corridor.area_from(0.3).min_rad));
  EXPECT_GT(corridor.area_from(0.0).max_rad, corridor.area_from(1.0).max_rad);
}

}  // namespace
}  // namespace nodmap::pitch_controller
