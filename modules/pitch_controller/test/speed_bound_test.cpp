// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/speed_bound.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace nodmap::pitch_controller {
namespace speed_bound_test {

const robot::Braking kBraking;
const DetectionParams kDetection;

TEST(SpeedBound, WithALongViewItIsTheSpeedFromWhichTheRobotCanStop) {
  EXPECT_DOUBLE_EQ(speed_bound({0.0, 2.0}, 0.35, kBraking, kDetection),
                   kBraking.permitted_mps(2.0, 0.75));
}

TEST(SpeedBound, AtTheBoundNoObstaclePassesThroughAShortViewUnseen) {
  // A clear view of 0.2 m, and 0.8 s from one measurement to the next.
  EXPECT_DOUBLE_EQ(speed_bound({3.8, 4.0}, 0.4, kBraking, kDetection), 0.25);
}

TEST(SpeedBound, WithoutAClearViewItIsZero) {
  EXPECT_EQ(speed_bound({2.0, 2.0}, 0.3, kBraking, kDetection), 0.0);
  EXPECT_EQ(speed_bound({std::numeric_limits<double>::infinity(), 4.0}, 0.3, kBraking, kDetection),
            0.0);
  EXPECT_EQ(speed_bound({0.0, 4.0}, std::numeric_limits<double>::quiet_NaN(), kBraking, kDetection),
            0.0);
}

TEST(SpeedBound, ARobotAtTheBoundAlwaysStopsBeforeTheObstacle) {
  // The robot drives towards an obstacle, which the laser hits at a random phase of the period once
  // it is in view.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 20'000; ++i) {
    const double near = 2.0 * uniform(random);
    const ClearView view{near, near + 0.05 + 3.0 * uniform(random)};
    const double sweep_s = 0.2 + uniform(random);
    const double v = speed_bound(view, sweep_s, kBraking, kDetection);
    // Measurements are one period apart; the obstacle enters the view between two of them.
    const double hit_after_s = 2.0 * sweep_s * uniform(random);
    const double hit_at_m = view.far_m - v * hit_after_s;
    EXPECT_GE(hit_at_m, view.near_m - 1e-9);  // rounding
    const double left_m =
        hit_at_m - v * kDetection.processing_s - v * v / (2.0 * kBraking.deceleration_mps2);
    if (v > 0.0) {
      EXPECT_GE(left_m, kBraking.stop_margin_m - 1e-9);
    }
  }
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
