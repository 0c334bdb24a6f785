// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/message_counts.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace nodmap::node {
namespace message_counts_test {

constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kGreatest = std::numeric_limits<std::int64_t>::max();

TEST(MessageCounts, CountsByCause) {
  MessageCounts counts;
  counts.use();
  counts.reject("scan_without_odometry");
  counts.reject("scan_without_odometry");
  counts.reject("implausible_scan");
  counts.reject("no_room", 4);
  counts.reject("disk_is_away", 0);
  counts.lose(3);
  EXPECT_EQ(counts.used(), 1);
  EXPECT_EQ(counts.total_rejected(), 7);
  EXPECT_EQ(counts.rejected().at("no_room"), 4);
  EXPECT_EQ(counts.rejected().count("disk_is_away"), 0U);
  EXPECT_EQ(counts.rejected().at("scan_without_odometry"), 2);
  EXPECT_EQ(counts.lost(), 3);
}

TEST(MessageCounts, OfLossesStaysAtTheGreatestNumber) {
  MessageCounts counts;
  counts.lose(kGreatest - 1);
  counts.lose(kGreatest);
  EXPECT_EQ(counts.lost(), kGreatest);
  counts.lose(1);
  EXPECT_EQ(counts.lost(), kGreatest);
}

TEST(SequenceCounter, CountsGapsButNoRestart) {
  SequenceCounter watch;
  EXPECT_EQ(watch.lost_before(100), 0);  // joined a running stream
  EXPECT_EQ(watch.lost_before(101), 0);
  EXPECT_EQ(watch.lost_before(105), 3);
  EXPECT_EQ(watch.lost_before(0), 0);  // the publisher started again
  EXPECT_EQ(watch.lost_before(2), 1);
}

TEST(SequenceCounter, TakesANegativeNumberForARestart) {
  SequenceCounter watch;
  EXPECT_EQ(watch.lost_before(7), 0);
  EXPECT_EQ(watch.lost_before(kLeast), 0);
  EXPECT_EQ(watch.lost_before(kGreatest), 0);
  EXPECT_EQ(watch.lost_before(-5), 0);
  EXPECT_EQ(watch.lost_before(-1), 0);
  EXPECT_EQ(watch.lost_before(0), 0);
  EXPECT_EQ(watch.lost_before(kGreatest), kGreatest - 1);
}

}  // namespace message_counts_test
}  // namespace nodmap::node
