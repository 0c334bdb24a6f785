// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/tally.hpp"

#include <gtest/gtest.h>

namespace nodmap::node {
namespace {

TEST(Tally, CountsByCause) {
  Tally tally;
  tally.use();
  tally.reject("no_odometry");
  tally.reject("no_odometry");
  tally.reject("implausible_scan");
  tally.lose(3);
  EXPECT_EQ(tally.used(), 1);
  EXPECT_EQ(tally.total_rejected(), 3);
  EXPECT_EQ(tally.rejected().at("no_odometry"), 2);
  EXPECT_EQ(tally.lost(), 3);
}

TEST(SequenceWatch, CountsGapsButNoRestart) {
  SequenceWatch watch;
  EXPECT_EQ(watch.lost_before(100), 0);  // joined a running stream
  EXPECT_EQ(watch.lost_before(101), 0);
  EXPECT_EQ(watch.lost_before(105), 3);
  EXPECT_EQ(watch.lost_before(0), 0);  // the publisher started again
  EXPECT_EQ(watch.lost_before(2), 1);
}

}  // namespace
}  // namespace nodmap::node
