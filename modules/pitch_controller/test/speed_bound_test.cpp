// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/speed_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace nodmap::pitch_controller {
namespace {

const VirtualCorridor kCorridor{0.05, 0.5, 0.38, 0.0};
constexpr Stopping kStopping{1.5, 0.05, 0.15};
constexpr PitchInterval kWide{-1.0, 1.0};

/// Whether lines of this spacing meet an upright obstacle of 5 cm above 5 cm, whatever their phase.
bool always_met(double distance_m, double spacing_rad) {
  for (double phase = 0.0; phase < 1.0; phase += 0.02) {
    bool met = false;
    for (int i = -1; (i + phase) * spacing_rad > -1.5 && !met; --i) {
      const double height = 0.38 + distance_m * std::tan((i + phase) * spacing_rad);
      met = height >= 0.05 && height <= 0.10;
    }
    if (!met) {
      return false;
    }
  }
  return true;
}

TEST(ClearView, WithinItEveryObstacleIsMet) {
  for (const double dp : {0.01, 0.02, 0.03}) {
    const ClearView view = clear_view(kCorridor, kWide, dp, 0.05, 10.0);
    ASSERT_GT(view.far_m, view.near_m);
    for (double d = view.near_m; d <= view.far_m; d += 0.02) {
      EXPECT_TRUE(always_met(d, dp)) << d << " m, " << dp;
    }
    // And it does not end much too early: the lever of the obstacle is 0.33 m at most, not 0.38.
    EXPECT_FALSE(always_met(1.1 * view.far_m, dp)) << dp << ", until " << view.far_m;
  }
}

TEST(ClearView, EndsWithTheLookAhead) {
  EXPECT_EQ(clear_view(kCorridor, kWide, 0.005, 0.05, 4.0).far_m, 4.0);
}

TEST(ClearView, LinesTooFarApartShowNothing) {
  const ClearView view = clear_view(kCorridor, kWide, 0.2, 0.05, 4.0);
  EXPECT_LE(view.far_m, view.near_m);
  const ClearView still = clear_view(kCorridor, kWide, 0.0, 0.05, 4.0);
  EXPECT_LE(still.far_m, still.near_m);
}

TEST(SpeedBound, IsTheStoppingSpeedWhereTheViewIsLong) {
  EXPECT_DOUBLE_EQ(speed_bound({0.0, 2.0}, 0.35, kStopping), kStopping.speed_mps(2.0, 0.75));
}

TEST(SpeedBound, NothingIsCarriedThroughAShortView) {
  // 0.2 m of view and 0.8 s from look to look.
  EXPECT_DOUBLE_EQ(speed_bound({3.8, 4.0}, 0.4, kStopping), 0.25);
}

TEST(SpeedBound, NothingSeenNoSpeed) {
  EXPECT_EQ(speed_bound({2.0, 2.0}, 0.3, kStopping), 0.0);
  EXPECT_EQ(speed_bound({std::numeric_limits<double>::infinity(), 4.0}, 0.3, kStopping), 0.0);
  EXPECT_EQ(speed_bound({0.0, 4.0}, std::numeric_limits<double>::quiet_NaN(), kStopping), 0.0);
}

TEST(SpeedBound, ARobotAtTheBoundAlwaysStopsBeforeTheObstacle) {
  // Drives towards an obstacle that is met at a random phase of the period once it is in view.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 20'000; ++i) {
    const double near = 2.0 * uniform(random);
    const ClearView view{near, near + 0.05 + 3.0 * uniform(random)};
    const double sweep_s = 0.2 + uniform(random);
    const double v = speed_bound(view, sweep_s, kStopping);
    // Looks come a period apart; the obstacle enters the view somewhere between two.
    const double met_after_s = 2.0 * sweep_s * uniform(random);
    const double met_at_m = view.far_m - v * met_after_s;
    EXPECT_GE(met_at_m, view.near_m - 1e-9);  // rounding
    const double left_m =
        met_at_m - v * kStopping.processing_s - v * v / (2.0 * kStopping.deceleration_mps2);
    if (v > 0.0) {
      EXPECT_GE(left_m, kStopping.margin_m - 1e-9);
    }
  }
}

}  // namespace
}  // namespace nodmap::pitch_controller
