// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/scan_gap.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace scan_gap_test {

TEST(ScanGap, WithoutAGapTheWholeBoundHolds) {
  ScanGap gap(2);
  for (int sweep = 0; sweep < 5; ++sweep) {
    gap.update(sweep);
    EXPECT_EQ(gap.speed_ratio(), 1.0);
  }
}

TEST(ScanGap, AfterAGapHalfOfTheBoundHoldsForTwoSweeps) {
  ScanGap gap(2);
  EXPECT_TRUE(gap.begin());
  EXPECT_TRUE(gap.begin()) << "still the same gap";
  for (const auto& [sweep, ratio] : {std::pair{10, 0.5}, {10, 0.5}, {11, 0.5}, {12, 1.0}}) {
    gap.update(sweep);
    EXPECT_EQ(gap.speed_ratio(), ratio) << sweep;
  }
  EXPECT_TRUE(gap.begin()) << "long after the first";
}

TEST(ScanGap, ASecondGapWithinTwoSweepsIsOneTooMany) {
  ScanGap gap(2);
  EXPECT_TRUE(gap.begin());
  gap.update(10);
  EXPECT_FALSE(gap.begin());
  gap.update(11);
  EXPECT_FALSE(gap.begin());
}

TEST(ScanGap, ASweepCountThatBeganAnewEndsTheSlowDriving) {
  ScanGap gap(2);
  EXPECT_TRUE(gap.begin());
  gap.update(10);
  gap.update(0);
  EXPECT_EQ(gap.speed_ratio(), 1.0);
}

}  // namespace scan_gap_test
}  // namespace nodmap::navigator
