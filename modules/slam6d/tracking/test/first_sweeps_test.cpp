// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/first_sweeps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

namespace nodmap::slam6d {
namespace first_sweeps_test {

PlacedSweep sweep_at(double x_m) {
  PlacedSweep sweep;
  sweep.scans.resize(20);
  for (PlacedSweep::PlacedScan& placed : sweep.scans) {
    placed.scan.ranges_m.assign(3, 1.0F);
  }
  sweep.T_odom_base.translation().x() = x_m;
  return sweep;
}

TEST(FirstSweeps, KeepsThirtyOfARobotThatMoves) {
  FirstSweeps sweeps;
  for (int i = 0; i < 30; ++i) {
    sweeps.add(sweep_at(0.1 * i));
  }
  ASSERT_TRUE(sweeps.are_kept());
  EXPECT_EQ(sweeps.sweeps().size(), 30U);
  EXPECT_EQ(sweeps.num_emptied(), 0U);
  sweeps.add(sweep_at(3.0));
  EXPECT_FALSE(sweeps.are_kept());
  EXPECT_TRUE(sweeps.sweeps().empty());
  sweeps.add(sweep_at(3.1));
  EXPECT_FALSE(sweeps.are_kept());
}

// After an hour at one place it still knows the first sweeps; of most their poses only.
TEST(FirstSweeps, KeepsThePosesOfAStationaryRobot) {
  FirstSweeps sweeps;
  for (int i = 0; i < 4000; ++i) {
    sweeps.add(sweep_at(0.01 * (i % 2)));
  }
  ASSERT_TRUE(sweeps.are_kept());
  ASSERT_EQ(sweeps.sweeps().size(), 4000U);
  EXPECT_EQ(sweeps.num_emptied(), 3997U);
  EXPECT_EQ(sweeps.sweeps()[2].scans.size(), 20U);
  const PlacedSweep& emptied = sweeps.sweeps()[3];
  ASSERT_EQ(emptied.scans.size(), 2U);
  EXPECT_TRUE(std::isnan(emptied.scans[1].scan.ranges_m[2]));
  EXPECT_EQ(emptied.T_odom_base.translation().x(), 0.01);
  sweeps.add(sweep_at(0.5));
  EXPECT_EQ(sweeps.sweeps().back().scans.size(), 20U);
}

TEST(FirstSweeps, ASweepOfOneScanKeepsIt) {
  FirstSweeps sweeps;
  PlacedSweep sweep = sweep_at(0.0);
  sweep.scans.resize(1);
  for (int i = 0; i < 5; ++i) {
    sweeps.add(sweep);
  }
  EXPECT_EQ(sweeps.sweeps().back().scans.size(), 1U);
}

TEST(FirstSweeps, NoneAreKeptAfterDrop) {
  FirstSweeps sweeps;
  sweeps.add(sweep_at(0.0));
  sweeps.drop();
  sweeps.add(sweep_at(0.0));
  EXPECT_FALSE(sweeps.are_kept());
  EXPECT_TRUE(sweeps.sweeps().empty());
}

}  // namespace first_sweeps_test
}  // namespace nodmap::slam6d
