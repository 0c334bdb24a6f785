// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/tally.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace nodmap::node {
namespace {

constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kGreatest = std::numeric_limits<std::int64_t>::max();

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

TEST(Tally, OfLossesStaysAtTheGreatestNumber) {
  Tally tally;
  tally.lose(kGreatest - 1);
  tally.lose(kGreatest);
  EXPECT_EQ(tally.lost(), kGreatest);
  tally.lose(1);
  EXPECT_EQ(tally.lost(), kGreatest);
}

TEST(SequenceWatch, CountsGapsButNoRestart) {
  SequenceWatch watch;
  EXPECT_EQ(watch.lost_before(100), 0);  // joined a running stream
  EXPECT_EQ(watch.lost_before(101), 0);
  EXPECT_EQ(watch.lost_before(105), 3);
  EXPECT_EQ(watch.lost_before(0), 0);  // the publisher started again
  EXPECT_EQ(watch.lost_before(2), 1);
}

TEST(SequenceWatch, TakesANegativeNumberForARestart) {
  SequenceWatch watch;
  EXPECT_EQ(watch.lost_before(7), 0);
  EXPECT_EQ(watch.lost_before(kLeast), 0);
  EXPECT_EQ(watch.lost_before(kGreatest), 0);
  EXPECT_EQ(watch.lost_before(-5), 0);
  EXPECT_EQ(watch.lost_before(-1), 0);
  EXPECT_EQ(watch.lost_before(0), 0);
  EXPECT_EQ(watch.lost_before(kGreatest), kGreatest - 1);
}

}  // namespace
}  // namespace nodmap::node
