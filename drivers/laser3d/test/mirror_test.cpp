// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/mirror.hpp"

#include <gtest/gtest.h>

#include "common/geometry/angle.hpp"

namespace nodmap::laser3d {
namespace {

using geometry::deg_to_rad;

SickScan numbered(int count) {
  SickScan scan;
  for (int i = 0; i < count; ++i) {
    scan.ranges_m.push_back(static_cast<float>(i));
  }
  return scan;
}

TEST(MirrorTurns, R1_OneDegreeIsOneTurnOf6660Microseconds) {
  const auto turns = mirror_turns(numbered(181), SickVariant::k180x100, 1'000'000);
  ASSERT_EQ(turns.size(), 1U);
  EXPECT_EQ(turns[0].last_beam_us, 1'000'000);
  EXPECT_EQ(turns[0].first_beam_us, 1'000'000 - 6660);
  EXPECT_DOUBLE_EQ(turns[0].angle_first_rad, deg_to_rad(-90.0));
  EXPECT_DOUBLE_EQ(turns[0].angle_step_rad, deg_to_rad(1.0));
  EXPECT_EQ(turns[0].ranges_m.size(), 181U);
}

TEST(MirrorTurns, R1_EveryBeamOfEveryVariantKeepsItsAngle) {
  for (const SickVariant variant :
       {SickVariant::k180x100, SickVariant::k180x050, SickVariant::k100x100, SickVariant::k100x050,
        SickVariant::k100x025}) {
    const SickGeometry geometry = geometry_of(variant);
    const auto turns = mirror_turns(numbered(geometry.num_values()), variant, 1'000'000);
    ASSERT_EQ(static_cast<int>(turns.size()), geometry.turns);
    std::size_t beams = 0;
    for (std::size_t k = 0; k < turns.size(); ++k) {
      beams += turns[k].ranges_m.size();
      for (std::size_t i = 0; i < turns[k].ranges_m.size(); ++i) {
        const double value = static_cast<double>(turns[k].ranges_m[i]);
        const double expected_deg =
            -0.5 * geometry.field_deg + 0.01 * geometry.resolution_cdeg * value;
        EXPECT_NEAR(turns[k].angle_first_rad + turns[k].angle_step_rad * static_cast<double>(i),
                    deg_to_rad(expected_deg), 1e-12);
      }
    }
    EXPECT_EQ(static_cast<int>(beams), geometry.num_values());
  }
}

TEST(MirrorTurns, TurnsOfOneScanLieATurnApart) {
  const auto turns = mirror_turns(numbered(401), SickVariant::k100x025, 1'000'000);
  ASSERT_EQ(turns.size(), 4U);
  for (std::size_t k = 1; k < 4; ++k) {
    // And a quarter of a degree further, 9 us.
    EXPECT_NEAR(static_cast<double>(turns[k].first_beam_us - turns[k - 1].first_beam_us),
                13'320.0 + 9.25, 1.0);
  }
}

TEST(MirrorTurns, InterlacedScansAreShifted) {
  SickScan scan = numbered(180);
  scan.quarter = 2;
  const MirrorTurn turn = interlaced_turn(scan, 1'000'000);
  EXPECT_DOUBLE_EQ(turn.angle_first_rad, deg_to_rad(-89.5));
  EXPECT_LT(turn.last_beam_us, 1'000'000);  // it ends half a degree before the half turn does
}

TEST(MirrorTurns, AnEmptyScanIsNoCrash) {
  EXPECT_TRUE(mirror_turns({}, SickVariant::k180x050, 0).at(1).ranges_m.empty());
}

}  // namespace
}  // namespace nodmap::laser3d
