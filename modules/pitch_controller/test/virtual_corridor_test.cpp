// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/virtual_corridor.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::pitch_controller {
namespace virtual_corridor_test {

using geometry::rad_to_deg;

TEST(VirtualCorridor, AnglesAreThoseOfTheReferenceTable) {
  // Measured from the axis, corridor from the floor to 0.47 m, laser at 0.38 m. The table has a
  // resolution of 0.1 degrees.
  const VirtualCorridor corridor{0.0, 0.47, 0.38, 0.0};
  EXPECT_NEAR(rad_to_deg(corridor.area_from(0.5).min_rad), -37.2, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(0.5).max_rad), 10.2, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(1.0).min_rad), -20.8, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(1.0).max_rad), 5.1, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(1.5).range_rad()), 17.6, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(2.0).range_rad()), 13.3, 0.06);
  EXPECT_NEAR(rad_to_deg(corridor.area_from(3.0).range_rad()), 8.9, 0.06);
}

TEST(VirtualCorridor, LinesAtTheEndsPassThroughTheCornersOfTheCorridor) {
  const VirtualCorridor corridor = VirtualCorridor::of(robot::RobotParams{});
  for (const double d : {0.1, 0.5, 1.0, 3.0}) {
    const PitchInterval area = corridor.area_from(d);
    // Eq. 1 for a beam straight ahead: at z from the axis it is z tan(pitch) above it. Base: the
    // front is 0.225 m ahead, the axis 0.15 m.
    const double z = d + 0.225 - 0.15;
    EXPECT_NEAR(0.38 + z * std::tan(area.min_rad), 0.05, 1e-12);
    EXPECT_NEAR(0.38 + z * std::tan(area.max_rad), 0.50, 1e-12);
  }
}

TEST(VirtualCorridor, CoveredFromIsTheInverseOfAreaFrom) {
  const VirtualCorridor corridor = VirtualCorridor::of(robot::RobotParams{});
  for (double d = 0.05; d < 6.0; d += 0.05) {
    EXPECT_NEAR(corridor.covered_from_m(corridor.area_from(d)), d, 1e-9);
  }
}

// Until there the outermost line passes below the top edge of a box at the bottom, and above the
// bottom edge of a board at the top: the definition, at the end that loses its obstacle first.
TEST(VirtualCorridor, ObstaclesAtBottomAndTopAreMetUntilTheOutermostLineMissesThem) {
  const VirtualCorridor corridor = VirtualCorridor::of(robot::RobotParams{});
  constexpr double kObstacleM = 0.05;
  for (const double d : {0.3, 0.5, 1.0, 2.0}) {
    const PitchInterval area = corridor.area_from(d);
    const double z = corridor.from_axis_m(corridor.met_from_m(d, kObstacleM));
    const double lowest_m = corridor.axis_height_m + z * std::tan(area.min_rad);
    const double highest_m = corridor.axis_height_m + z * std::tan(area.max_rad);
    EXPECT_NEAR(lowest_m, corridor.bottom_m + kObstacleM, 1e-12) << d;
    EXPECT_GE(highest_m, corridor.top_m - kObstacleM) << d;
  }
}

TEST(VirtualCorridor, TheEndThatCoversLessDecides) {
  const VirtualCorridor corridor = VirtualCorridor::of(robot::RobotParams{});
  const PitchInterval one = corridor.area_from(1.0);
  const PitchInterval two = corridor.area_from(2.0);
  EXPECT_NEAR(corridor.covered_from_m({one.min_rad, two.max_rad}), 2.0, 1e-9);
  EXPECT_NEAR(corridor.covered_from_m({two.min_rad, one.max_rad}), 2.0, 1e-9);
}

TEST(VirtualCorridor, SomePitchesNeverCoverIt) {
  const VirtualCorridor corridor = VirtualCorridor::of(robot::RobotParams{});
  EXPECT_TRUE(std::isinf(corridor.covered_from_m({0.0, 0.5})));   // never the bottom
  EXPECT_TRUE(std::isinf(corridor.covered_from_m({-0.5, 0.0})));  // never the top
  EXPECT_TRUE(std::isinf(corridor.covered_from_m({0.1, -0.1})));
  // Pitches beyond straight up and down cover the corridor from the front on.
  EXPECT_EQ(corridor.covered_from_m({-3.0, 3.0}), 0.0);
}

TEST(VirtualCorridor, ALaserAboveTheCorridorDoesNotLookUp) {
  const VirtualCorridor corridor{0.05, 0.30, 0.38, 0.0};
  EXPECT_LT(corridor.area_from(1.0).max_rad, 0.0);
  EXPECT_NEAR(corridor.covered_from_m({-0.5, 0.0}), 0.33 / std::tan(0.5), 1e-12);
}

TEST(VirtualCorridor, AFrontBehindTheLaserCausesNoDivisionByZero) {
  const VirtualCorridor corridor{0.05, 0.5, 0.38, -0.3};
  EXPECT_TRUE(std::isfinite(corridor.area_from(0.3).min_rad));
  EXPECT_GT(corridor.area_from(0.0).max_rad, corridor.area_from(1.0).max_rad);
}

constexpr PitchInterval kCorridorArea{-0.3, 0.1};
constexpr PitchInterval kMechanics{-1.0, 0.9};

TEST(AreaOfInterest, AtStandstillAndAtTopSpeedItsEndsAreExact) {
  const PitchInterval stationary = area_of_interest(0.0, 1.0, kCorridorArea, kMechanics);
  EXPECT_DOUBLE_EQ(stationary.min_rad, -1.0);
  EXPECT_DOUBLE_EQ(stationary.max_rad, 0.9);
  for (const double v : {1.0, 1.5, 100.0}) {
    const PitchInterval fast = area_of_interest(v, 1.0, kCorridorArea, kMechanics);
    EXPECT_EQ(fast.min_rad, -0.3);
    EXPECT_EQ(fast.max_rad, 0.1);
  }
}

TEST(AreaOfInterest, BothEndsCloseAsTheSpeedGrows) {
  PitchInterval before = area_of_interest(0.0, 1.0, kCorridorArea, kMechanics);
  for (double v = 0.01; v <= 1.0; v += 0.01) {
    const PitchInterval now = area_of_interest(v, 1.0, kCorridorArea, kMechanics);
    EXPECT_GT(now.min_rad, before.min_rad);
    EXPECT_LT(now.max_rad, before.max_rad);
    before = now;
  }
}

TEST(AreaOfInterest, IsNeverBeyondTheLimitsOfTheHead) {
  const PitchInterval area = area_of_interest(5.0, 1.0, {-2.0, 2.0}, kMechanics);
  EXPECT_EQ(area.min_rad, -1.0);
  EXPECT_EQ(area.max_rad, 0.9);
}

TEST(AreaOfInterest, BackwardsItIsAsAtStandstill) {
  EXPECT_DOUBLE_EQ(area_of_interest(-0.5, 1.0, kCorridorArea, kMechanics).min_rad, -1.0);
}

const VirtualCorridor kCorridorAtTheAxis{0.05, 0.5, 0.38, 0.0};
constexpr PitchInterval kWide{-1.0, 1.0};

// Whether lines of this spacing hit an upright obstacle from 5 to 10 cm height at any phase.
bool always_hit(double distance_m, double spacing_rad) {
  for (double phase = 0.0; phase < 1.0; phase += 0.02) {
    bool hit = false;
    for (int i = -1; (i + phase) * spacing_rad > -1.5 && !hit; --i) {
      const double height = 0.38 + distance_m * std::tan((i + phase) * spacing_rad);
      hit = height >= 0.05 && height <= 0.10;
    }
    if (!hit) {
      return false;
    }
  }
  return true;
}

TEST(ClearView, EveryObstacleWithinItIsHit) {
  for (const double dp : {0.01, 0.02, 0.03}) {
    const ClearView view = clear_view(kCorridorAtTheAxis, kWide, dp, 0.05, 10.0);
    ASSERT_GT(view.far_m, view.near_m);
    for (double d = view.near_m; d <= view.far_m; d += 0.02) {
      EXPECT_TRUE(always_hit(d, dp)) << d << " m, " << dp;
    }
    // Nor does it end much too early: the obstacle is at most 0.33 m below the axis instead of 0.38
    // m, a difference of less than 10 %.
    EXPECT_FALSE(always_hit(1.1 * view.far_m, dp)) << dp << ", until " << view.far_m;
  }
}

// The outermost line may lie one spacing within the end of the sweep, and nearer than where the
// corridor is covered, or the lines are dense enough, obstacles are missed.
TEST(ClearView, BeginsWhereTheOutermostLineCoversTheCorridor) {
  constexpr double kSpacingRad = 0.01;
  for (const double covered_m : {1.0, 2.0}) {
    const PitchInterval covers = kCorridorAtTheAxis.area_from(covered_m);
    const PitchInterval ends{covers.min_rad - kSpacingRad, covers.max_rad + kSpacingRad};
    for (const PitchInterval& seen :
         {ends, PitchInterval{ends.min_rad, 1.0}, {-1.0, ends.max_rad}}) {
      EXPECT_NEAR(clear_view(kCorridorAtTheAxis, seen, kSpacingRad, 0.05, 4.0).near_m, covered_m,
                  1e-9);
    }
  }
  // Lines of 0.06 rad are no more than 5 cm apart from 0.246 to 0.588 m only: o^2 > 4 dp^2 h^2.
  EXPECT_NEAR(clear_view(kCorridorAtTheAxis, {-1.5, 1.5}, 0.06, 0.05, 4.0).near_m, 0.2457, 1e-4);
}

TEST(Revisit, ContainsTheReversal) {
  const NodMotion nod{{-0.5, 0.5}, 2.0, 0.1};
  NodMotion without = nod;
  without.reversal_s = 0.0;
  EXPECT_NEAR(revisit_s(kCorridorAtTheAxis, nod, 1.0, 0.0),
              revisit_s(kCorridorAtTheAxis, without, 1.0, 0.0) + 0.1, 1e-12);
}

TEST(ClearView, EndsAtTheLookAheadDistance) {
  EXPECT_EQ(clear_view(kCorridorAtTheAxis, kWide, 0.005, 0.05, 4.0).far_m, 4.0);
}

TEST(ClearView, WithLinesTooFarApartThereIsNone) {
  const ClearView view = clear_view(kCorridorAtTheAxis, kWide, 0.2, 0.05, 4.0);
  EXPECT_LE(view.far_m, view.near_m);
  const ClearView still = clear_view(kCorridorAtTheAxis, kWide, 0.0, 0.05, 4.0);
  EXPECT_LE(still.far_m, still.near_m);
}

}  // namespace virtual_corridor_test
}  // namespace nodmap::pitch_controller
