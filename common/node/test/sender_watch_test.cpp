// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/sender_watch.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace nodmap::node {
namespace sender_watch_test {

constexpr time::Duration kPeriod = 13'320us;

/// A sender at 75 Hz, followed from `now` on; the time of its last message.
time::SteadyTime send(SenderWatch& watch, std::int64_t& seq, int count, time::SteadyTime now) {
  for (int i = 0; i < count; ++i, now += kPeriod) {
    EXPECT_TRUE(watch.follow(seq++, now));
  }
  return now - kPeriod;
}

TEST(SenderWatch, OneSenderIsFollowedEvenWhenMessagesAreLost) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  time::SteadyTime now = send(watch, seq, 100, {});
  EXPECT_TRUE(watch.follow(seq + 10, now + 11 * kPeriod));
  EXPECT_FALSE(watch.is_contested(now + 11 * kPeriod));
}

TEST(SenderWatch, ARestartedSenderIsFollowedWhenTheFormerIsGone) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  const time::SteadyTime last = send(watch, seq, 100, {});
  EXPECT_FALSE(watch.follow(0, last + SenderWatch::kSilence - 1us));
  EXPECT_TRUE(watch.follow(1, last + SenderWatch::kSilence));
  EXPECT_TRUE(watch.follow(2, last + SenderWatch::kSilence + kPeriod));
  EXPECT_FALSE(watch.is_contested(last + SenderWatch::kSilence + kPeriod));
}

TEST(SenderWatch, TwoSendersAreNoticedWhateverTheNumbersOfTheSecond) {
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kSmallest = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t first : {std::int64_t{0}, std::int64_t{4990}, std::int64_t{5103},
                                   std::int64_t{5150}, kLargest - 1000, kSmallest}) {
    SenderWatch watch;
    std::int64_t seq = 5000;
    time::SteadyTime now = send(watch, seq, 100, {});
    std::int64_t forged = first;
    int periods = 0;
    for (; !watch.is_contested(now) && periods < 100; ++periods) {
      now += kPeriod;
      static_cast<void>(watch.follow(forged++, now - kPeriod / 2));
      static_cast<void>(watch.follow(seq++, now));
    }
    EXPECT_LE(periods, 4) << "the second sender counts from " << first;
  }
}

// The second sender guesses the next number, so its message is accepted and the legitimate one is
// the stranger.
TEST(SenderWatch, ASecondSenderThatCopiesTheNumbersIsNoticed) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  time::SteadyTime now = send(watch, seq, 100, {});
  int periods = 0;
  for (; !watch.is_contested(now) && periods < 100; ++periods, ++seq) {
    now += kPeriod;
    static_cast<void>(watch.follow(seq, now - kPeriod / 2));
    static_cast<void>(watch.follow(seq, now));
  }
  EXPECT_LE(periods, 4);
}

/// For how much of the time a message of the second sender is in force, if no message is used while
/// the watch is contested. The second sender listens: every `pause` it sends `count` messages that
/// skip `step` numbers each.
double ratio_in_force(time::Duration pause, int count, std::int64_t step) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  std::int64_t last = seq;
  time::SteadyTime now = send(watch, seq, 100, {});
  time::SteadyTime next = now;
  bool is_forged = false;
  int num_forged = 0;
  constexpr int kPeriods = 2000;
  for (int i = 0; i < kPeriods; ++i, ++seq) {
    now += kPeriod;
    if (watch.follow(seq, now)) {
      last = seq;
      is_forged = false;
    }
    if (now >= next) {
      next = now + pause;
      for (int k = 0; k < count; ++k) {
        is_forged = watch.follow(last + step, now + 1ms) || is_forged;
        last += step;
      }
    }
    num_forged += is_forged && !watch.is_contested(now + 1ms) ? 1 : 0;
  }
  return static_cast<double>(num_forged) / kPeriods;
}

constexpr bus::Sender kOwn{0x7F000001, 40'000};
constexpr bus::Sender kOther{0x7F000001, 40'001};

// Of each message that is sent, the second sender knows the number of the next one.
TEST(SenderWatch, ASecondSocketIsRefusedWhateverItsNumbers) {
  SenderWatch watch;
  time::SteadyTime now;
  int contested = 0;
  for (std::int64_t seq = 0; seq < 1000; ++seq, now += kPeriod) {
    EXPECT_TRUE(watch.follow(seq, now, kOwn));
    EXPECT_FALSE(watch.follow(seq + 1, now + kPeriod / 2, kOther));
    contested += watch.is_contested(now) ? 1 : 0;
  }
  EXPECT_GE(contested, 996);
}

// Two messages a second are too few to be sure of a second sender; none is used.
TEST(SenderWatch, ASecondSocketThatSendsSeldomHasNoEffect) {
  SenderWatch watch;
  time::SteadyTime now;
  for (std::int64_t seq = 0; seq < 1000; ++seq, now += kPeriod) {
    EXPECT_TRUE(watch.follow(seq, now, kOwn));
    if (seq % 38 == 0) {
      EXPECT_FALSE(watch.follow(seq + 1, now, kOther));
    }
    EXPECT_FALSE(watch.is_contested(now));
  }
}

TEST(SenderWatch, ASenderThatRestartsOnAnotherSocketIsFollowedWhenTheFormerIsGone) {
  SenderWatch watch;
  time::SteadyTime now;
  EXPECT_TRUE(watch.follow(4999, now, kOwn));
  for (std::int64_t seq = 5000; now < time::SteadyTime{1s}; ++seq) {
    now += kPeriod;
    EXPECT_EQ(watch.follow(seq, now, kOther), now >= time::SteadyTime{SenderWatch::kSilence});
    EXPECT_FALSE(watch.is_contested(now));
  }
}

// At 210 ms each message comes when the former has been in force for as long as a sender may be
// silent.
TEST(SenderWatch, ASecondSenderThatListensAndJumpsAheadIsNoticed) {
  for (const std::int64_t step : {1, 2, 3, 50, 100}) {
    for (const int count : {1, 2}) {
      EXPECT_LT(ratio_in_force(210ms, count, step), 0.02) << count << " " << step;
      // Too seldom to be contested all the time: at most three messages of 75 in force.
      EXPECT_LT(ratio_in_force(1100ms, count, step), 0.04) << count << " " << step;
    }
  }
}

TEST(SenderWatch, AMessageThatIsRefusedDoesNotContinueTheSequence) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  const time::SteadyTime now = send(watch, seq, 100, {}) + kPeriod;
  watch.refuse(seq + 50, now);
  EXPECT_TRUE(watch.follow(seq, now));
  EXPECT_FALSE(watch.is_contested(now));
}

TEST(SenderWatch, ASecondSenderWhoseMessagesAreRefusedIsNoticed) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  time::SteadyTime now = send(watch, seq, 100, {});
  for (int i = 0; i < 4; ++i, ++seq) {
    now += kPeriod;
    watch.refuse(seq + 50, now - kPeriod / 2);
    EXPECT_TRUE(watch.follow(seq, now));
  }
  EXPECT_TRUE(watch.is_contested(now));
}

// Its clock differs, or it was frozen: none of its messages can be used for a while.
TEST(SenderWatch, OneSenderWithRefusedMessagesIsNoSecondSender) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  time::SteadyTime now = send(watch, seq, 100, {});
  for (int i = 0; i < 50; ++i) {
    now += kPeriod;
    i % 7 == 0 ? static_cast<void>(watch.follow(seq++, now)) : watch.refuse(seq++, now);
    EXPECT_FALSE(watch.is_contested(now));
  }
}

// A fifth of the messages is lost, at random.
TEST(SenderWatch, ALossyNetworkIsNoSecondSender) {
  SenderWatch watch;
  std::mt19937 random(1);
  time::SteadyTime now;
  for (std::int64_t seq = 0; seq < 10'000; ++seq, now += kPeriod) {
    if (random() % 5 != 0) {
      EXPECT_TRUE(watch.follow(seq, now));
      EXPECT_FALSE(watch.is_contested(now));
    }
  }
}

// It counts from 0 while the former is still believed to be alive.
TEST(SenderWatch, ASenderThatRestartsAtOnceIsNoSecondSender) {
  SenderWatch watch;
  std::int64_t seq = 0;
  time::SteadyTime now = send(watch, seq, 5000, {});
  const time::SteadyTime last = now;
  for (seq = 0; now < last + SenderWatch::kSilence; ++seq) {
    now += kPeriod;
    EXPECT_EQ(watch.follow(seq, now), now - last >= SenderWatch::kSilence);
    EXPECT_FALSE(watch.is_contested(now));
  }
  send(watch, seq, 100, now + kPeriod);
  EXPECT_FALSE(watch.is_contested(now + 100 * kPeriod));
}

TEST(SenderWatch, ItIsOverASecondAfterTheSecondSenderHasEnded) {
  SenderWatch watch;
  std::int64_t seq = 5000;
  time::SteadyTime now;
  for (int i = 0; i < 100; ++i, now += kPeriod) {
    static_cast<void>(watch.follow(i, now));
    static_cast<void>(watch.follow(seq++, now));
  }
  ASSERT_TRUE(watch.is_contested(now));
  for (const time::SteadyTime end = now + SenderWatch::kContested; now < end;) {
    static_cast<void>(watch.follow(seq++, now));
    now += kPeriod;
  }
  EXPECT_FALSE(watch.is_contested(now));
  EXPECT_TRUE(watch.follow(seq, now));
}

// A clock that was an hour ahead is set back: the conflict noted at the later time must not last
// for an hour.
TEST(SenderWatch, AClockThatIsSetBackForgets) {
  SenderWatch watch;
  constexpr time::SteadyTime kLater(1h);
  constexpr time::SteadyTime kNow(kPeriod);
  std::int64_t seq = 0;
  for (int i = 0; i < 10; ++i) {
    static_cast<void>(watch.follow(seq++, kLater + i * kPeriod));
    static_cast<void>(watch.follow(1'000'000 + i, kLater + i * kPeriod));
  }
  ASSERT_TRUE(watch.is_contested(kLater + 10 * kPeriod));
  EXPECT_FALSE(watch.is_contested(kNow));
  EXPECT_TRUE(watch.follow(seq, kNow));
  EXPECT_FALSE(watch.is_contested(kNow));
}

TEST(SenderWatch, AMessageOvertakenOnTheNetworkIsNoSecondSender) {
  SenderWatch watch;
  std::int64_t seq = 0;
  time::SteadyTime now;
  for (int round = 0; round < 10; ++round) {  // one in 100: in 1.3 s
    now = send(watch, seq, 98, now) + kPeriod;
    EXPECT_TRUE(watch.follow(seq + 1, now));
    EXPECT_FALSE(watch.follow(seq, now));
    EXPECT_FALSE(watch.is_contested(now));
    seq += 2;
    now += 2 * kPeriod;
  }
}

}  // namespace sender_watch_test
}  // namespace nodmap::node
