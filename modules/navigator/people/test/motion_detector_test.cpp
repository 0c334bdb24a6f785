// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/motion_detector.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "modules/navigator/people/test/walking_scene.hpp"

namespace nodmap::navigator {
namespace motion_detector_test {

// SCAN says that space is free only up to the longest range.
TEST(MotionDetector, WithoutAnEchoSpaceIsFreeUpToTheLongestRange) {
  scan::Scan scan = test::WalkingScene{}.scan(test::at(0.0), {}, 0.0);
  scan.ranges_m.assign(scan.ranges_m.size(), std::numeric_limits<float>::infinity());
  for (const double range_max_m : {80.0, 2.0}) {
    scan.range_max_m = range_max_m;
    MotionDetector detector;
    (void)detector.add_scan(scan, {}, false);
    EXPECT_TRUE(detector.space().is_passed_now({1.5, 0.0}));
    EXPECT_EQ(detector.space().is_passed_now({3.0, 0.0}), range_max_m > 3.0);
  }
}

}  // namespace motion_detector_test
}  // namespace nodmap::navigator
