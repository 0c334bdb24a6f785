// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/ever_free.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace ever_free_test {

const Eigen::Vector2d kPlace(1.05, 0.05);
constexpr double kHeightM = 0.3;
constexpr time::Timestamp kBegin{1000s};

// Five scans see the space around the place free, then scans see nothing there for `hidden`. The
// robot turns by 1 rad meanwhile, which counts as 4 m of travel: only the time keeps it known.
bool is_free_after(time::Duration hidden, time::Duration scan_period) {
  EverFree space(3.0);
  time::Timestamp stamp = kBegin;
  for (int scan = 0; scan < 5; ++scan, stamp += scan_period) {
    space.begin_scan(stamp, {});
    for (double y = -0.25; y <= 0.35; y += 0.05) {
      space.pass({0.3, y}, kHeightM, {2.0, y}, kHeightM);
    }
  }
  const time::Timestamp last_pass = stamp - scan_period;
  for (; stamp < last_pass + hidden; stamp += scan_period) {
    space.begin_scan(stamp, {0.0, 0.0, 1.0});
  }
  space.begin_scan(last_pass + hidden, {0.0, 0.0, 1.0});
  constexpr bool kLaserIsHeld = true;
  return space.is_free(kPlace, kHeightM, kLaserIsHeld);
}

// How long space that a held laser no longer sees counts as free is a time, whatever its rate.
TEST(EverFree, AHeldLaserKnowsSpaceForASecondAtAnyRate) {
  for (const time::Duration scan_period : {10ms, 25ms, 100ms}) {
    EXPECT_TRUE(is_free_after(950ms, scan_period)) << scan_period.count();
    EXPECT_FALSE(is_free_after(1050ms, scan_period)) << scan_period.count();
  }
}

// A stamp that steps back by an hour must not keep space known until the hour is over.
TEST(EverFree, SpaceIsNotKnownAfterTheClockHasSteppedBack) {
  EXPECT_FALSE(is_free_after(-3600s, 25ms));
}

}  // namespace ever_free_test
}  // namespace nodmap::navigator
