// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/speed_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace nodmap::pitch_controller {
namespace speed_bound_test {

const robot::Braking kBraking;
const DetectionParams kDetection;

const VirtualCorridor kCorridor = VirtualCorridor::of(robot::RobotParams{});

// Sweeps over the corridor beyond `near_m`.
NodMotion nod_from(double near_m, double rate_rad_s) {
  return {kCorridor.area_from(near_m), rate_rad_s, rate_rad_s / 40.0};
}

double bound_of(const ClearView& view, const NodMotion& nod, const UnseenPlaces& unseen = {}) {
  return speed_bound({view, nod}, unseen, kCorridor, kBraking, kDetection);
}

TEST(SpeedBound, IsBetweenThoseOfOneAndOfTwoSweeps) {
  const NodMotion nod = nod_from(0.5, 1.5);
  const double sweep_s = nod.ends.range_rad() / nod.rate_rad_s + nod.reversal_s;
  const double v = bound_of({0.0, 3.0}, nod);
  EXPECT_GT(v, kBraking.permitted_mps(3.0, kDetection.reaction_s(sweep_s)));
  EXPECT_LT(v, kBraking.permitted_mps(3.0, sweep_s + kDetection.processing_s));
}

TEST(SpeedBound, AtTheBoundNoObstaclePassesThroughAShortViewUnseen) {
  const NodMotion nod = nod_from(3.8, 0.3);
  const double v = bound_of({3.8, 4.0}, nod);
  EXPECT_GT(v, 0.0);
  EXPECT_NEAR(v * revisit_s(kCorridor, nod, 4.0, v), 0.2, 1e-3);  // half a millimetre per second
}

TEST(SpeedBound, WithoutAClearViewItIsZero) {
  const NodMotion nod = nod_from(0.5, 1.5);
  EXPECT_EQ(bound_of({2.0, 2.0}, nod), 0.0);
  EXPECT_EQ(bound_of({std::numeric_limits<double>::infinity(), 4.0}, nod), 0.0);
  EXPECT_EQ(bound_of({0.0, 4.0}, {nod.ends, std::numeric_limits<double>::quiet_NaN(), 0.1}), 0.0);
}

// Brute force: a strip at any height of the corridor comes into view at any moment of the nod, and
// the robot drives towards it at the bound.
TEST(SpeedBound, ARobotAtTheBoundAlwaysStopsBeforeTheObstacle) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int num_driven = 0;
  for (int i = 0; i < 500; ++i) {
    const double near_m = 0.1 + 2.0 * uniform(random);
    const ClearView view{near_m, near_m + 0.05 + 3.0 * uniform(random)};
    NodMotion nod = nod_from(near_m, 0.2 + 2.5 * uniform(random));
    nod.reversal_s = 0.0;  // so that the pitch is a triangle
    const double v = bound_of(view, nod);
    num_driven += v > 0.05 ? 1 : 0;
    const double height_m =
        kCorridor.bottom_m + uniform(random) * (kCorridor.top_m - kCorridor.bottom_m);
    const auto strip_rad = [&](double t) {
      return std::atan((height_m - kCorridor.axis_height_m) /
                       kCorridor.from_axis_m(view.far_m - v * t));
    };
    const double range_rad = nod.ends.range_rad();
    const double phase_rad = 2.0 * range_rad * uniform(random);
    const auto pitch_rad = [&](double t) {
      const double turned_rad = std::fmod(phase_rad + nod.rate_rad_s * t, 2.0 * range_rad);
      return nod.ends.min_rad +
             (turned_rad < range_rad ? turned_rad : 2.0 * range_rad - turned_rad);
    };
    constexpr double kStepS = 1e-3;
    const bool is_above = pitch_rad(0.0) > strip_rad(0.0);
    double t = 0.0;
    while (t < 60.0 && (pitch_rad(t) > strip_rad(t)) == is_above) {
      t += kStepS;
    }
    const double left_m =
        view.far_m - v * (t + kDetection.processing_s) - v * v / (2.0 * kBraking.deceleration_mps2);
    if (v > 0.0) {
      EXPECT_GE(left_m, kBraking.stop_margin_m - 2.0 * v * kStepS) << i;
      EXPECT_GE(view.far_m - v * t, near_m - 2.0 * v * kStepS) << i;
    }
  }
  EXPECT_GT(num_driven, 400);
}

// A robot that was slow when something may have appeared must measure that place before it is fast.
TEST(SpeedBound, APlaceThatWasNotMeasuredYetLimitsIt) {
  const NodMotion nod = nod_from(0.5, 1.5);
  const ClearView view{0.5, 3.0};
  const double free_mps = bound_of(view, nod);
  UnseenPlaces unseen;
  unseen.add(1.0);
  const double v = bound_of(view, nod, unseen);
  EXPECT_LT(v, free_mps);
  const double hit_m = 1.0 - v * revisit_s(kCorridor, nod, 1.0, v);
  const double d_min_m = kBraking.required_distance_m(v, kDetection.processing_s);
  const double met_m = kCorridor.met_from_m(d_min_m, kDetection.visible_obstacle_m);
  EXPECT_NEAR(hit_m, met_m, 2e-3);  // the bound is exact to half a millimetre per second
  // After two sweeps the laser has measured it.
  unseen.advance(0.0, 2.0 * (nod.ends.range_rad() + nod.reversal_s * nod.rate_rad_s));
  unseen.forget_measured(nod, revisit_s(kCorridor, nod, 1.0, v));
  EXPECT_DOUBLE_EQ(bound_of(view, nod, unseen), free_mps);
}

// The laser does not see the corridor as near as planned, so the place must be measured earlier.
TEST(SpeedBound, WhereTheNodFallsShortThePlaceIsMeasuredFartherAway) {
  const NodMotion nod = nod_from(0.5, 1.5);
  UnseenPlaces unseen;
  unseen.add(1.0);
  constexpr double kShortM = 0.2;
  const double v = speed_bound({{0.5, 3.0}, nod, kShortM}, unseen, kCorridor, kBraking, kDetection);
  ASSERT_GT(v, 0.05);
  const double hit_m = 1.0 - v * revisit_s(kCorridor, nod, 1.0, v);
  const double d_min_m = kBraking.required_distance_m(v, kDetection.processing_s);
  EXPECT_NEAR(hit_m, kCorridor.met_from_m(d_min_m + kShortM, kDetection.visible_obstacle_m), 2e-3);
}

// A tall obstacle is met before the corridor is seen completely, but the robot must stop for it.
TEST(SpeedBound, AnObstacleThatIsMetLateLeavesRoomToStopWithFullForce) {
  DetectionParams tall = kDetection;
  tall.visible_obstacle_m = 0.3;
  const NodMotion nod = nod_from(0.5, 1.5);
  UnseenPlaces unseen;
  unseen.add(1.0);
  const double v = speed_bound({{0.1, 3.0}, nod}, unseen, kCorridor, kBraking, tall);
  const double left_m =
      1.0 - v * revisit_s(kCorridor, nod, 1.0, v) -
      robot::stopping_distance(v, tall.processing_s, kBraking.emergency_deceleration_mps2);
  EXPECT_NEAR(left_m, 0.05, 2e-3);
}

TEST(RisingBound, FallsAtOnceAndRisesSlowly) {
  RisingBound rising(0.5);
  EXPECT_DOUBLE_EQ(rising.limit(2.0, 0.0, 0.1), 0.05);
  EXPECT_DOUBLE_EQ(rising.limit(2.0, 0.0, 0.1), 0.10);
  // Never more than 0.2 m/s above the present speed.
  EXPECT_DOUBLE_EQ(rising.limit(2.0, 0.0, 1.0), 0.2);
  // The robot is faster than the last bound, so the bound rises from the robot's speed.
  EXPECT_DOUBLE_EQ(rising.limit(2.0, 1.0, 0.1), 1.05);
  EXPECT_EQ(rising.limit(0.0, 1.0, 0.1), 0.0);
}

}  // namespace speed_bound_test
}  // namespace nodmap::pitch_controller
