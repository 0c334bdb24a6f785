// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/sender_watch.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace nodmap::node {
namespace {

constexpr std::int64_t kPeriodUs = 13'320;

/// A sender at 75 Hz, followed from `now_us` on; the time of its last message.
std::int64_t send(SenderWatch& watch, std::int64_t& seq, int count, std::int64_t now_us) {
  for (int i = 0; i < count; ++i, now_us += kPeriodUs) {
    EXPECT_TRUE(watch.follow(seq++, now_us));
  }
  return now_us - kPeriodUs;
}

TEST(SenderWatch, OneSenderIsFollowedAlsoWhenMessagesAreLost) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  std::int64_t now_us = send(watch, seq, 100, 0);
  EXPECT_TRUE(watch.follow(seq + 10, now_us + 11 * kPeriodUs));
  EXPECT_FALSE(watch.is_contested(now_us + 11 * kPeriodUs));
}

TEST(SenderWatch, ASenderThatStartsAnewIsFollowedWhenTheFormerIsGone) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  const std::int64_t last_us = send(watch, seq, 100, 0);
  EXPECT_FALSE(watch.follow(0, last_us + SenderWatch::kSilenceUs - 1));
  EXPECT_TRUE(watch.follow(1, last_us + SenderWatch::kSilenceUs));
  EXPECT_TRUE(watch.follow(2, last_us + SenderWatch::kSilenceUs + kPeriodUs));
  EXPECT_FALSE(watch.is_contested(last_us + SenderWatch::kSilenceUs + kPeriodUs));
}

TEST(SenderWatch, TwoSendersAreNoticedWhateverTheNumbersOfTheSecond) {
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kSmallest = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t first : {std::int64_t{0}, std::int64_t{4990}, std::int64_t{5103},
                                   std::int64_t{5150}, kLargest - 1000, kSmallest}) {
    SenderWatch watch;
    std::int64_t seq = 5000;
    std::int64_t now_us = send(watch, seq, 100, 0);
    std::int64_t forged = first;
    int periods = 0;
    for (; !watch.is_contested(now_us) && periods < 100; ++periods) {
      now_us += kPeriodUs;
      static_cast<void>(watch.follow(forged++, now_us - kPeriodUs / 2));
      static_cast<void>(watch.follow(seq++, now_us));
    }
    EXPECT_LE(periods, 4) << "the second sender counts from " << first;
  }
}

// It sends the number that comes next: first a message of its own, then the right one is a
// stranger.
TEST(SenderWatch, ASecondSenderThatCopiesTheNumbersIsNoticed) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  std::int64_t now_us = send(watch, seq, 100, 0);
  int periods = 0;
  for (; !watch.is_contested(now_us) && periods < 100; ++periods, ++seq) {
    now_us += kPeriodUs;
    static_cast<void>(watch.follow(seq, now_us - kPeriodUs / 2));
    static_cast<void>(watch.follow(seq, now_us));
  }
  EXPECT_LE(periods, 4);
}

TEST(SenderWatch, ItIsOverASecondAfterTheSecondSenderHasEnded) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  std::int64_t now_us = 0;
  for (int i = 0; i < 100; ++i, now_us += kPeriodUs) {
    static_cast<void>(watch.follow(i, now_us));
    static_cast<void>(watch.follow(seq++, now_us));
  }
  ASSERT_TRUE(watch.is_contested(now_us));
  for (const std::int64_t end_us = now_us + SenderWatch::kContestedUs; now_us < end_us;) {
    static_cast<void>(watch.follow(seq++, now_us));
    now_us += kPeriodUs;
  }
  EXPECT_FALSE(watch.is_contested(now_us));
  EXPECT_TRUE(watch.follow(seq, now_us));
}

// A wall clock that was an hour ahead: what it said of the future must not hold for an hour.
TEST(SenderWatch, AClockThatIsSetBackForgets) {
  SenderWatch watch;
  constexpr std::int64_t kHourUs = 3'600'000'000;
  std::int64_t seq = 0;
  for (int i = 0; i < 10; ++i) {
    (void)watch.follow(seq++, kHourUs + i * kPeriodUs);
    (void)watch.follow(1'000'000 + i, kHourUs + i * kPeriodUs);
  }
  ASSERT_TRUE(watch.is_contested(kHourUs + 10 * kPeriodUs));
  EXPECT_FALSE(watch.is_contested(kPeriodUs));
  EXPECT_TRUE(watch.follow(seq, kPeriodUs));
  EXPECT_FALSE(watch.is_contested(kPeriodUs));
}

TEST(SenderWatch, AMessageOvertakenOnTheNetworkIsNoSecondSender) {
  SenderWatch watch;
  std::int64_t seq = 0;
  std::int64_t now_us = 0;
  for (int round = 0; round < 10; ++round) {  // one in 100: in 1.3 s
    now_us = send(watch, seq, 98, now_us) + kPeriodUs;
    EXPECT_TRUE(watch.follow(seq + 1, now_us));
    EXPECT_FALSE(watch.follow(seq, now_us));
    EXPECT_FALSE(watch.is_contested(now_us));
    seq += 2;
    now_us += 2 * kPeriodUs;
  }
}

}  // namespace
}  // namespace nodmap::node
