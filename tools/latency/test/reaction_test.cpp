// SPDX-License-Identifier: BSD-3-Clause
#include "tools/latency/reaction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/codec.hpp"

namespace nodmap::latency {
namespace reaction_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ReactionTest : public ::testing::Test {
 protected:
  template <class Message>
  void add(const char* channel, const Message& message, std::int64_t received_utime) {
    std::vector<std::byte> bytes;
    bus::encode_into(bytes, message);
    reaction_.add(channel, bytes, time::from_utime(received_utime));
  }

  void add_scan(std::int64_t seq, std::int64_t received_utime) {
    scan_t scan{};
    scan.scan_seq = seq;
    add("SCAN", scan, received_utime);
  }
  void add_map(std::int64_t seq, std::int64_t utime, std::int64_t received_utime) {
    egomap_t map{};
    map.scan_seq = seq;
    map.utime = utime;
    add("OBSTACLE_MAP", map, received_utime);
  }
  void add_drive(std::int64_t seq, std::int64_t utime, std::int64_t received_utime) {
    drive_t drive{};
    drive.drive_seq = seq;
    drive.utime = utime;
    add("DRIVE", drive, received_utime);
  }

  static std::vector<std::int64_t> waits(const std::vector<Sample>& samples) {
    std::vector<std::int64_t> result;
    for (const Sample& sample : samples) {
      result.push_back(time::to_us(sample.wait));
    }
    return result;
  }

  Reaction reaction_;
};

TEST_F(ReactionTest, IsFromTheScanToItsMapAndToTheCommandAfterIt) {
  add_scan(7, 1000);
  add_map(7, 900, 1300);
  add_drive(0, 900, 1500);
  add_scan(8, 14000);
  add_map(8, 13900, 14100);
  add_drive(1, 13900, 14900);
  EXPECT_THAT(waits(reaction_.scan_to_map()), ElementsAre(300, 100));
  EXPECT_THAT(waits(reaction_.scan_to_drive()), ElementsAre(500, 900));
}

TEST_F(ReactionTest, ACommandOnOlderDataIsNoAnswer) {
  add_scan(7, 1000);
  add_map(7, 900, 1300);
  add_drive(0, 850, 1400);
  EXPECT_THAT(reaction_.scan_to_drive(), IsEmpty());
  add_drive(1, 900, 2400);
  EXPECT_THAT(waits(reaction_.scan_to_drive()), ElementsAre(1400));
}

// If a navigator uses two maps at once, the first one had to wait.
TEST_F(ReactionTest, OneCommandAnswersAllMapsBeforeIt) {
  add_scan(1, 0);
  add_map(1, 10, 100);
  add_scan(2, 13000);
  add_map(2, 13010, 13100);
  add_drive(0, 13010, 13500);
  EXPECT_THAT(waits(reaction_.scan_to_drive()), ElementsAre(13500, 500));
}

TEST_F(ReactionTest, AScanWithoutAMapIsLeftOut) {
  add_scan(1, 0);
  add_scan(2, 13000);
  add_map(2, 13010, 13100);
  add_map(1, 10, 14000);
  EXPECT_THAT(waits(reaction_.scan_to_map()), ElementsAre(100));
}

TEST_F(ReactionTest, CountsMissingAndCorruptMessages) {
  add_scan(1, 0);
  add_scan(4, 1);
  add_scan(0, 2);  // restarted: nothing was lost
  add_drive(3, 0, 3);
  add_drive(5, 0, 4);
  reaction_.add("SCAN", {}, time::from_utime(5));
  EXPECT_EQ(reaction_.lost().at("SCAN"), 2);
  EXPECT_EQ(reaction_.lost().at("DRIVE"), 1);
  EXPECT_EQ(reaction_.corrupt(), 1);
  EXPECT_EQ(reaction_.scans(), 3);
}

TEST(Summary, IsByNearestRank) {
  std::vector<Sample> samples;
  for (std::int64_t i = 200; i >= 1; --i) {
    samples.push_back({{}, time::Duration(i)});
  }
  const Summary summary = summarize(samples);
  EXPECT_EQ(summary.n, 200U);
  EXPECT_EQ(summary.min, 1us);
  EXPECT_EQ(summary.p50, 100us);
  EXPECT_EQ(summary.p99, 198us);
  EXPECT_EQ(summary.max, 200us);
  EXPECT_EQ(summarize({}).n, 0U);
}

TEST(UsOverTime, ShowsAQueueThatGrows) {
  std::vector<Sample> samples;
  for (std::int64_t i = 0; i < 100; ++i) {
    samples.push_back({time::from_utime(1000 * i), time::Duration(i)});
  }
  EXPECT_THAT(us_over_time(samples, 4, &Summary::p99), ElementsAre(24, 49, 74, 99));
  EXPECT_THAT(us_over_time(samples, 4, &Summary::min), ElementsAre(0, 25, 50, 75));
  EXPECT_THAT(us_over_time({}, 2, &Summary::p99), ElementsAre(0, 0));
  const std::vector<Sample> one = {{time::from_utime(5), 6us}};
  EXPECT_THAT(us_over_time(one, 2, &Summary::p99), ElementsAre(6, 0));
}

}  // namespace reaction_test
}  // namespace nodmap::latency
