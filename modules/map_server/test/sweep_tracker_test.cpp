// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/sweep_tracker.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/angle.hpp"

namespace nodmap::map_server {
namespace sweep_tracker_test {

using geometry::deg_to_rad;

constexpr double kSigmaRad = deg_to_rad(0.03);

// A scan at a reversal counts for the new sweep from its middle on: half a step of one degree.
const double kHalfStep = deg_to_rad(0.5 + 1e-9);

// Nods between the bounds for a number of sweeps from reversal to reversal.
void nod(SweepTracker& tracker, double low_deg, double high_deg, int sweeps, double step_deg = 1) {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (double p = low_deg; p < high_deg - 1e-9; p += step_deg) {
      const double from = sweep % 2 == 0 ? p : high_deg + low_deg - p;
      const double to = sweep % 2 == 0 ? p + step_deg : high_deg + low_deg - p - step_deg;
      tracker.add(deg_to_rad(from), deg_to_rad(to));
    }
  }
}

TEST(SweepTracker, CountsReversals) {
  for (const double step_deg : {0.25, 1.0, 5.0}) {
    SweepTracker tracker(kSigmaRad);
    nod(tracker, -20, 10, 7, step_deg);
    EXPECT_EQ(tracker.sweep(), 6) << "step " << step_deg;  // the seventh is not complete
  }
}

TEST(SweepTracker, KnowsTheRangeOfPitchAfterTwoSweeps) {
  SweepTracker tracker(kSigmaRad);
  nod(tracker, -20, 10, 2);
  EXPECT_FALSE(tracker.covered());
  nod(tracker, -20, 10, 2);
  ASSERT_TRUE(tracker.covered());
  EXPECT_NEAR(tracker.covered()->min_rad, deg_to_rad(-20), kHalfStep);
  EXPECT_NEAR(tracker.covered()->max_rad, deg_to_rad(10), kHalfStep);
}

TEST(SweepTracker, TakesTheNarrowerOfTwoSweeps) {
  SweepTracker tracker(kSigmaRad);
  nod(tracker, -20, 10, 4);
  nod(tracker, -10, 10, 2);  // starts with a jump up, which is a part of the last sweep
  nod(tracker, -10, 10, 2);
  ASSERT_TRUE(tracker.covered());
  EXPECT_NEAR(tracker.covered()->min_rad, deg_to_rad(-10), kHalfStep);
  nod(tracker, -20, 10, 1);
  EXPECT_NEAR(tracker.covered()->min_rad, deg_to_rad(-10), kHalfStep)
      << "one wide sweep is not two";
}

TEST(SweepTracker, NoiseOfThePitchDoesNotCountAsAReversal) {
  SweepTracker tracker(kSigmaRad);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-0.08, 0.08);
  for (int i = 0; i < 400; ++i) {
    const double p = deg_to_rad(-20 + 0.05 * i + noise(random));
    tracker.add(p, p);
  }
  EXPECT_EQ(tracker.sweep(), 0);
}

// 50 degrees at 0.25 degrees a scan, the paper's finest nod, 100 sweeps. The first reversal begins
// the count, and one that noise hides or adds may occur.
TEST(SweepTracker, CountsTheSweepsOfANoisyHead) {
  for (const double sigma_deg : {0.05, 0.1, 0.15}) {
    SweepTracker tracker(deg_to_rad(sigma_deg));
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, sigma_deg);
    double width_rad = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      const double pitch_deg = 0.25 * std::abs(i % 400 - 200) - 30.0;
      const double measured_rad = deg_to_rad(pitch_deg + noise(random));
      tracker.add(measured_rad, measured_rad);
      if (const auto covered = tracker.covered()) {
        width_rad = covered->max_rad - covered->min_rad;
      }
    }
    EXPECT_NEAR(static_cast<double>(tracker.sweep()), 99.0, 1.0) << sigma_deg;
    EXPECT_NEAR(geometry::rad_to_deg(width_rad), 50.0, 1.0) << sigma_deg;
  }
}

TEST(SweepTracker, WithALevelScannerEveryScanIsASweep) {
  SweepTracker tracker(kSigmaRad);
  for (int i = 0; i < 100; ++i) {
    tracker.add(0.0, 0.0);
  }
  EXPECT_GT(tracker.sweep(), 80);
  ASSERT_TRUE(tracker.covered());
  EXPECT_EQ(tracker.covered()->min_rad, 0.0);
  EXPECT_EQ(tracker.covered()->max_rad, 0.0);
}

}  // namespace sweep_tracker_test
}  // namespace nodmap::map_server
