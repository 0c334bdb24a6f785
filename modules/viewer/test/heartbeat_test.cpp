// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/heartbeat.hpp"

#include <gtest/gtest.h>

namespace nodmap::viewer {
namespace heartbeat_test {

constexpr time::SteadyTime kOpened{100s};

TEST(Heartbeat, AMessageIsAtMostAsOldAsTheNewestPingThatWasAnswered) {
  Heartbeat heartbeat(kOpened);
  EXPECT_EQ(heartbeat.max_age(kOpened + 300ms), 300ms) << "the handshake is as good as a ping";
  const auto ping = heartbeat.next_ping(kOpened + 500ms);
  ASSERT_TRUE(ping);
  EXPECT_EQ(heartbeat.max_age(kOpened + 600ms), 600ms) << "it is not yet answered";
  heartbeat.take_pong(*ping);
  EXPECT_EQ(heartbeat.max_age(kOpened + 600ms), 100ms);
}

TEST(Heartbeat, OnePingIsUnderWayAtATime) {
  Heartbeat heartbeat(kOpened);
  EXPECT_FALSE(heartbeat.next_ping(kOpened + Heartbeat::kPeriod - 1us));
  const auto first = heartbeat.next_ping(kOpened + Heartbeat::kPeriod);
  ASSERT_TRUE(first);
  EXPECT_FALSE(heartbeat.next_ping(kOpened + 20s));
  heartbeat.take_pong(*first);
  EXPECT_NE(heartbeat.next_ping(kOpened + 20s), first);
}

// After an outage of 20 s, the answer to the ping of its beginning comes first.
TEST(Heartbeat, ALateAnswerMakesNothingYounger) {
  Heartbeat heartbeat(kOpened);
  const auto ping = heartbeat.next_ping(kOpened + 1s);
  ASSERT_TRUE(ping);
  heartbeat.take_pong(*ping);
  const auto late = heartbeat.next_ping(kOpened + 2s);
  ASSERT_TRUE(late);
  EXPECT_EQ(heartbeat.max_age(kOpened + 22s), 21s);
  heartbeat.take_pong(*late);
  EXPECT_EQ(heartbeat.max_age(kOpened + 22s), 20s);
}

TEST(Heartbeat, AnswersToOtherPingsAreIgnored) {
  Heartbeat heartbeat(kOpened);
  heartbeat.take_pong("0");
  const auto ping = heartbeat.next_ping(kOpened + 1s);
  ASSERT_TRUE(ping);
  for (const char* payload : {"", "0", "2"}) {
    heartbeat.take_pong(payload);
    EXPECT_EQ(heartbeat.max_age(kOpened + 2s), 2s) << payload;
  }
  heartbeat.take_pong(*ping);
  heartbeat.take_pong(*ping);
  EXPECT_EQ(heartbeat.max_age(kOpened + 2s), 1s);
}

}  // namespace heartbeat_test
}  // namespace nodmap::viewer
