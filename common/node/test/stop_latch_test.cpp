// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/stop_latch.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "common/node/process_names.hpp"
#include "tests/support/program.hpp"

namespace nodmap::node {
namespace stop_latch_test {

using Change = StopLatch::Change;

nodmap::stop_t message(bool is_stopped, std::int64_t utime, const std::string& by) {
  nodmap::stop_t message{};
  message.is_stopped = static_cast<std::int8_t>(is_stopped);
  message.utime = utime;
  message.requested_by = by;
  return message;
}

nodmap::stop_t repetition(std::int64_t utime) {
  return message(true, utime, confirmed_name("a bumper"));
}

// The driver of another robot may be written in another language.
TEST(StopLatch, TheDocumentSaysByWhatABaseDriverIsRecognised) {
  const std::string document = test::slurp(NODMAP_OWN_ROBOT);
  for (const std::string& text : {"`process_name` is `" + std::string(kBaseDriver) + "`",
                                  "`" + confirmed_name("NAME") + "`"}) {
    EXPECT_NE(document.find(text), std::string::npos) << text;
  }
}

TEST(StopLatch, AStopHoldsUntilItIsReleased) {
  StopLatch latch;
  EXPECT_FALSE(latch.is_stopped());
  EXPECT_EQ(latch.take(message(true, 7, "page")), Change::kStopped);
  EXPECT_EQ(latch.take(message(true, 8, "nodmap-stop")), Change::kNone);
  EXPECT_EQ(latch.stopped_by(), "nodmap-stop");
  EXPECT_EQ(latch.take(message(false, 9, "page")), Change::kReleased);
  EXPECT_FALSE(latch.is_stopped());
  EXPECT_EQ(latch.take(message(false, 10, "page")), Change::kNone);
}

TEST(StopLatch, TheBaseDriverIsStoppedAfterItsStart) {
  StopLatch latch("its start");
  EXPECT_EQ(latch.stopped_by(), "its start");
  EXPECT_EQ(latch.take(message(false, 1, "page")), Change::kReleased);
  EXPECT_EQ(latch.stop("a bumper"), Change::kStopped);
  EXPECT_EQ(latch.stopped_by(), "a bumper");
}

// The clock of the host that releases is an hour behind or ahead, or was set back between two
// releases: none of them is taken for older than the STOP, or for a copy.
TEST(StopLatch, TheTimeOfAReleaseDoesNotMatter) {
  StopLatch latch;
  constexpr std::int64_t kStopped = 5'000'000'000;
  for (const std::int64_t after_s : {0, -3600, 3600, -3601}) {
    latch.take(message(true, kStopped, "page"));
    EXPECT_EQ(latch.take(message(false, kStopped + 1'000'000 * after_s, "page")), Change::kReleased)
        << after_s;
  }
}

// A viewer repeats STOP five times a second, always with the time of the decision. One that goes on
// after a release has not received it, or contradicts it. The copies of the release do not matter
// to the base driver, which has the last word.
TEST(StopLatch, ARepetitionOfAViewerStopsAgain) {
  const nodmap::stop_t stop = message(true, 7, "nodmap-viewer");
  const nodmap::stop_t release = message(false, 9, "nodmap-stop");
  for (const bool is_base_driver : {false, true}) {
    StopLatch latch = is_base_driver ? StopLatch("its start") : StopLatch();
    latch.take(stop);
    latch.take(release);
    EXPECT_EQ(latch.take(stop), Change::kStopped);
    EXPECT_EQ(latch.stopped_by(), "nodmap-viewer");
    latch.take(release);
    EXPECT_EQ(latch.is_stopped(), is_base_driver);
    EXPECT_EQ(latch.take(stop), is_base_driver ? Change::kNone : Change::kStopped);
  }
}

// Sixteen releases are remembered: far more than a person gives while copies are on their way.
TEST(StopLatch, ACopyOfAnOlderReleaseLiftsNothing) {
  StopLatch latch;
  for (std::int64_t utime = 1; utime <= 16; ++utime) {
    latch.take(message(false, utime, "page"));
  }
  latch.take(message(true, 17, "page"));
  for (std::int64_t utime = 1; utime <= 16; ++utime) {
    EXPECT_EQ(latch.take(message(false, utime, "page")), Change::kNone);
  }
  EXPECT_EQ(latch.take(message(false, 16, "another page")), Change::kReleased);
}

TEST(StopLatch, OnlyTheFirstCopyOfAReleaseIsNew) {
  StopLatch latch;
  for (const std::int64_t utime : {1, 2}) {
    const nodmap::stop_t release = message(false, utime, "page");
    EXPECT_TRUE(latch.is_new_release(release));
    latch.take(release);
    EXPECT_FALSE(latch.is_new_release(release));
  }
  EXPECT_FALSE(latch.is_new_release(message(true, 3, "page")));
}

// The base driver recognises what it has repeated before it asks the latch, so these are another's.
TEST(StopLatch, TheBaseDriverTakesARepetitionOfAnotherForAStop) {
  StopLatch latch("its start");
  latch.take(message(false, 1, "page"));
  EXPECT_EQ(latch.take(repetition(2)), Change::kStopped);
  EXPECT_EQ(latch.stopped_by(), "a bumper") << "not by the driver that repeats it";
  EXPECT_EQ(latch.take(message(false, 1, "page")), Change::kNone);
  EXPECT_TRUE(latch.is_stopped());
}

// All sequences of six messages: STOP of two persons, one that the base driver repeats, and two
// releases. The robot is stopped if, after the last release that is no copy, there was a STOP of a
// person that was no repetition, or any repetition that no copy followed.
TEST(StopLatch, TheRuleHoldsInAllSequences) {
  const std::vector<nodmap::stop_t> messages{message(true, 1, "page"), message(true, 2, "somebody"),
                                             repetition(3), message(false, 4, "page"),
                                             message(false, 5, "page")};
  constexpr std::size_t kRepetition = 2;
  constexpr int kNumSequences = 5 * 5 * 5 * 5 * 5 * 5;
  for (int sequence = 0; sequence < kNumSequences; ++sequence) {
    StopLatch latch;
    std::size_t last_person = kRepetition;  // none
    bool is_stopped_by_person = false;
    bool is_stopped_by_repetition = false;
    std::string last_repeated;
    std::set<std::size_t> releases;
    for (int rest = sequence, i = 0; i < 6; rest /= 5, ++i) {
      const auto which = static_cast<std::size_t>(rest % 5);
      if (which > kRepetition) {
        const bool is_copy = !releases.insert(which).second;
        is_stopped_by_person = is_stopped_by_person && is_copy;
        is_stopped_by_repetition = false;
      } else if (which == kRepetition || which == last_person) {
        is_stopped_by_repetition = true;
        last_repeated = messages[which].requested_by;
      } else {
        last_person = which;
        is_stopped_by_person = true;
      }
      latch.take(messages[which]);
      ASSERT_EQ(latch.is_stopped(), is_stopped_by_person || is_stopped_by_repetition)
          << "sequence " << sequence << ", message " << i;
      if (is_stopped_by_person) {
        ASSERT_EQ(latch.stopped_by(), messages[last_person].requested_by);
      } else if (is_stopped_by_repetition) {
        ASSERT_EQ(latch.stopped_by(), last_repeated);
      }
    }
  }
}

}  // namespace stop_latch_test
}  // namespace nodmap::node
