// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/contact/slip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nodmap::navigator {
namespace slip_test {

// Four poses a second. The wheels measure `wheels_mps`, of which the robot drives a fraction.
// Returns after how many seconds slip is reported; negative if never within 10 s.
double noticed_after_s(double wheels_mps, double driven_fraction) {
  SlipMonitor monitor;
  std::mt19937 random(11);
  std::normal_distribution<double> error_m(0.0, 0.01);
  for (int i = 0; i < 40; ++i) {
    const double x = 0.25 * i * wheels_mps;
    if (monitor.update(time::Timestamp(250ms * i), {x, 0.0, 0.0},
                       {driven_fraction * x + error_m(random), error_m(random), 0.0})) {
      return 0.25 * i;
    }
  }
  return -1.0;
}

TEST(SlipMonitor, IsReportedWhenTheWheelsTurnButTheRobotHardlyMoves) {
  for (const double mps : {0.15, 0.3, 1.0}) {
    const double after_s = noticed_after_s(mps, 0.0);
    EXPECT_GT(after_s, 0.0) << mps;
    EXPECT_LE(after_s, 1.0) << mps;
  }
}

TEST(SlipMonitor, IsSilentWhileTheRobotMovesOrIsStationary) {
  for (const double mps : {0.0, 0.05, 0.3, 1.5}) {
    EXPECT_LT(noticed_after_s(mps, 1.0), 0.0) << mps;
    EXPECT_LT(noticed_after_s(mps, 0.6), 0.0) << mps;
  }
}

TEST(SlipMonitor, AStampThatStepsBackBeginsAnew) {
  SlipMonitor monitor;
  EXPECT_FALSE(monitor.update(time::Timestamp(1s), {}, {}));
  EXPECT_FALSE(monitor.update(time::Timestamp(500ms), {0.5, 0.0, 0.0}, {}));
  EXPECT_FALSE(monitor.update(time::Timestamp(700ms), {0.8, 0.0, 0.0}, {}));
  EXPECT_TRUE(monitor.update(time::Timestamp(900ms), {1.1, 0.0, 0.0}, {}));
}

// The loop is closed at 2 s, and wheels that count too much have led the pose too far ahead.
TEST(SlipMonitor, ACorrectionOfThePoseIsNoSlip) {
  for (const double mps : {0.15, 0.3, 0.5, 1.0}) {
    for (const time::Duration period : {250ms, 500ms, 1000ms}) {
      for (double jump_m = -1.0; jump_m < 0.0; jump_m += 0.05) {
        SlipMonitor monitor;
        for (time::Duration at{}; at < 10s; at += period) {
          const double x = mps * time::seconds(at);
          EXPECT_FALSE(monitor.update(time::Timestamp(at), {x, 0.0, 0.0},
                                      {at < 2s ? x : x + jump_m, 0.0, 0.0}))
              << mps << " m/s, " << jump_m << " m, after " << time::seconds(at) << " s";
        }
      }
    }
  }
}

// As seldom as 2D SLAM gets level scans while the head sweeps slowly.
TEST(SlipMonitor, IsReportedWithAPoseEachSecond) {
  SlipMonitor monitor;
  EXPECT_FALSE(monitor.update(time::Timestamp(0s), {}, {}));
  EXPECT_FALSE(monitor.update(time::Timestamp(1s), {0.2, 0.0, 0.0}, {}));
  EXPECT_TRUE(monitor.update(time::Timestamp(2s), {0.4, 0.0, 0.0}, {}));
}

}  // namespace slip_test
}  // namespace nodmap::navigator
