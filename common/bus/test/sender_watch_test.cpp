// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/sender_watch.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace nodmap::bus {
namespace sender_watch_test {

constexpr time::Duration kPeriod = 13'320us;  // 75 Hz
constexpr Sender kOwn{0x7F000001, 40'000};
constexpr Sender kOther{0x7F000001, 40'001};
constexpr Sender kOtherHost{0x7F000002, 40'000};

// The first sender alone, from `now` on; the time after its last message.
time::SteadyTime send(SenderWatch& watch, int count, time::SteadyTime now) {
  for (int i = 0; i < count; ++i, now += kPeriod) {
    EXPECT_TRUE(watch.follow(kOwn, now));
    EXPECT_FALSE(watch.is_contested(now));
  }
  return now;
}

TEST(SenderWatch, ASecondSenderIsRefusedAndNoticed) {
  for (const Sender& second : {kOther, kOtherHost}) {
    SenderWatch watch;
    time::SteadyTime now = send(watch, 100, {});
    for (int i = 0; i < 100; ++i, now += kPeriod) {
      EXPECT_FALSE(watch.follow(second, now - kPeriod / 2));
      EXPECT_TRUE(watch.follow(kOwn, now));
      EXPECT_EQ(watch.is_contested(now), i >= 2) << "known from the third message on";
    }
  }
}

// Two messages a second are too few to stop for; none is used.
TEST(SenderWatch, ASecondSenderThatSendsSeldomHasNoEffect) {
  SenderWatch watch;
  time::SteadyTime now;
  for (int i = 0; i < 1000; ++i, now += kPeriod) {
    EXPECT_TRUE(watch.follow(kOwn, now));
    if (i % 38 == 0) {
      EXPECT_FALSE(watch.follow(kOther, now));
    }
    EXPECT_FALSE(watch.is_contested(now));
  }
}

// Three of them within a second, whenever that begins, and however the messages of the accepted
// sender lie between them.
TEST(SenderWatch, ASecondSenderIsNoticedWhereverItsSecondBegins) {
  using Times = std::vector<time::Duration>;
  for (const Times& strangers : {Times{0ms, 950ms, 1050ms, 1150ms}, Times{0ms, 500ms, 995ms}}) {
    SenderWatch watch;
    const time::SteadyTime begin = send(watch, 100, {});
    time::SteadyTime now = begin;
    for (const time::Duration stranger : strangers) {
      for (; now <= begin + stranger; now += kPeriod) {
        EXPECT_TRUE(watch.follow(kOwn, now));
        EXPECT_FALSE(watch.is_contested(now));
      }
      EXPECT_FALSE(watch.follow(kOther, begin + stranger));
    }
    now = begin + strangers.back() + kPeriod;
    EXPECT_TRUE(watch.follow(kOwn, now));
    EXPECT_TRUE(watch.is_contested(now));
  }
}

// It sends while the former is still believed to be alive.
TEST(SenderWatch, ARestartedSenderIsFollowedWhenTheFormerIsGone) {
  SenderWatch watch;
  time::SteadyTime now;
  EXPECT_TRUE(watch.follow(kOwn, now));
  while (now < time::SteadyTime{1s}) {
    now += kPeriod;
    EXPECT_EQ(watch.follow(kOther, now), now >= time::SteadyTime{SenderWatch::kSilence});
    EXPECT_FALSE(watch.is_contested(now));
  }
}

TEST(SenderWatch, ASecondSenderWhoseMessagesAreRefusedIsNoticed) {
  SenderWatch watch;
  time::SteadyTime now = send(watch, 100, {});
  for (int i = 0; i < 3; ++i, now += kPeriod) {
    watch.refuse(kOther, now - kPeriod / 2);
    EXPECT_TRUE(watch.follow(kOwn, now));
  }
  EXPECT_TRUE(watch.is_contested(now - kPeriod));
}

// Its clock differs, or it was frozen: most of its messages cannot be used.
TEST(SenderWatch, OneSenderWithRefusedMessagesIsNoSecondSender) {
  SenderWatch watch;
  time::SteadyTime now = send(watch, 100, {});
  for (int i = 0; i < 50; ++i, now += kPeriod) {
    i % 7 == 0 ? static_cast<void>(watch.follow(kOwn, now)) : watch.refuse(kOwn, now);
    EXPECT_FALSE(watch.is_contested(now));
  }
}

TEST(SenderWatch, ItIsOverASecondAfterTheSecondSenderHasEnded) {
  SenderWatch watch;
  time::SteadyTime now;
  for (int i = 0; i < 100; ++i, now += kPeriod) {
    EXPECT_TRUE(watch.follow(kOwn, now));
    EXPECT_FALSE(watch.follow(kOther, now));
  }
  const time::SteadyTime last = now - kPeriod;
  ASSERT_TRUE(watch.is_contested(last));
  for (; now < last + SenderWatch::kContested; now += kPeriod) {
    EXPECT_TRUE(watch.follow(kOwn, now));
    EXPECT_TRUE(watch.is_contested(now));
  }
  EXPECT_FALSE(watch.is_contested(last + SenderWatch::kContested));
}

// A clock that was an hour ahead is set back: the conflict noted at the later time must not last
// for an hour.
TEST(SenderWatch, AClockThatIsSetBackForgets) {
  SenderWatch watch;
  constexpr time::SteadyTime kLater(1h);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(watch.follow(kOwn, kLater + i * kPeriod));
    EXPECT_FALSE(watch.follow(kOther, kLater + i * kPeriod));
  }
  ASSERT_TRUE(watch.is_contested(kLater + 10 * kPeriod));
  const time::SteadyTime now(kPeriod);
  EXPECT_FALSE(watch.is_contested(now));
  EXPECT_TRUE(watch.follow(kOwn, now));
  EXPECT_FALSE(watch.is_contested(now));
  EXPECT_FALSE(watch.is_contested(kLater + 10 * kPeriod));
}

// Reports that come once a second: a restart is none, one message in addition is a second sender.
TEST(SenderWatch, OfRareMessagesOneOfASecondSenderIsNoticed) {
  constexpr time::Duration kLong = 3s;
  SenderWatch watch(kLong);
  EXPECT_TRUE(watch.follow(kOwn, {}));
  EXPECT_FALSE(watch.follow(kOther, time::SteadyTime{1s}));
  EXPECT_FALSE(watch.is_contested(time::SteadyTime{1s}));
  EXPECT_TRUE(watch.follow(kOther, time::SteadyTime{kLong})) << "it has taken over";
  EXPECT_FALSE(watch.is_contested(time::SteadyTime{kLong}));
  EXPECT_FALSE(watch.follow(kOwn, time::SteadyTime{kLong + 500ms}));
  EXPECT_TRUE(watch.follow(kOther, time::SteadyTime{kLong + 1s}));
  EXPECT_TRUE(watch.is_contested(time::SteadyTime{kLong + 1s}));
  EXPECT_FALSE(watch.is_contested(time::SteadyTime{kLong + 500ms + kLong}));
}

}  // namespace sender_watch_test
}  // namespace nodmap::bus
