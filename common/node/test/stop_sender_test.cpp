// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/stop_sender.hpp"

#include <gtest/gtest.h>

#include "common/node/stop_latch.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::node {
namespace stop_sender_test {

constexpr time::Timestamp kStart{1'700'000'000s};

nodmap::stop_t message(bool is_stopped, const std::string& by, time::Timestamp decided = kStart) {
  nodmap::stop_t stop{};
  stop.utime = time::to_utime(decided);
  stop.is_stopped = static_cast<std::int8_t>(is_stopped);
  stop.requested_by = by;
  return stop;
}

class StopSenderTest : public testing::Test {
 protected:
  [[nodiscard]] std::vector<nodmap::stop_t> sent() const {
    return bus_.sent<nodmap::stop_t>("STOP");
  }
  // Lets a second pass, in which it is called often.
  void pass_a_second() {
    for (time::Duration passed{}; passed < 1s; passed += 50ms) {
      now_ += 50ms;
      sender_.repeat_if_due(now_);
    }
  }

  test::MemoryBus bus_;
  StopSender sender_{bus_, "me"};
  time::Timestamp now_ = kStart;
};

TEST_F(StopSenderTest, SendsNothingUnasked) {
  pass_a_second();
  sender_.take(message(true, confirmed_name("its start")));
  pass_a_second();
  EXPECT_TRUE(sent().empty());
}

TEST_F(StopSenderTest, RepeatsAStopUntilTheRobotIsReleased) {
  sender_.stop(now_);
  EXPECT_EQ(sent().size(), 1U) << "at once";
  EXPECT_FALSE(sender_.is_sent());
  pass_a_second();
  ASSERT_EQ(sent().size(), 6U) << "every 200 ms";
  EXPECT_TRUE(sender_.is_sent());
  for (std::size_t i = 0; i < sent().size(); ++i) {
    EXPECT_EQ(sent()[i].is_stopped, 1);
    EXPECT_EQ(sent()[i].requested_by, "me");
    EXPECT_EQ(sent()[i].stop_seq, static_cast<std::int64_t>(i));
    EXPECT_EQ(sent()[i].utime, time::to_utime(kStart)) << "when it was decided";
  }
  sender_.take(message(false, "somebody", kStart + 500ms));
  pass_a_second();
  EXPECT_EQ(sent().size(), 6U);
}

// The releasing host's clock may be ahead of ours, or behind it.
TEST_F(StopSenderTest, ACopyOfAnEarlierReleaseDoesNotEndAStopWhateverTheClocksSay) {
  for (const time::Duration ahead : {-10s, 10s}) {
    const std::size_t before = sent().size();
    sender_.take(message(false, "somebody", now_ + ahead));
    sender_.stop(now_);
    sender_.take(message(false, "somebody", now_ + ahead));
    pass_a_second();
    EXPECT_EQ(sent().size(), before + 6U) << "at once and every 200 ms";
    sender_.release(now_);
    pass_a_second();
  }
}

TEST_F(StopSenderTest, ALaterReleaseEndsAStopWhateverTheClocksSay) {
  sender_.stop(now_);
  sender_.take(message(false, "somebody", kStart - 10s));
  pass_a_second();
  EXPECT_EQ(sent().size(), 1U);
}

TEST_F(StopSenderTest, SendsAReleaseSeveralTimes) {
  sender_.release(now_);
  pass_a_second();
  pass_a_second();
  ASSERT_EQ(sent().size(), static_cast<std::size_t>(StopSender::kNumCopies));
  for (const nodmap::stop_t& copy : sent()) {
    EXPECT_EQ(copy.is_stopped, 0);
    EXPECT_EQ(copy.utime, time::to_utime(kStart));
  }
}

// Whoever obeys it takes the copies for what they are.
TEST_F(StopSenderTest, NoCopyOfAReleaseLiftsAStopThatIsNewer) {
  sender_.release(now_);
  StopLatch base_driver("its start");
  EXPECT_EQ(base_driver.take(sent().front()), StopLatch::Change::kReleased);
  base_driver.take(message(true, "somebody"));
  pass_a_second();
  for (const nodmap::stop_t& copy : sent()) {
    base_driver.take(copy);
  }
  EXPECT_TRUE(base_driver.is_stopped());
}

TEST_F(StopSenderTest, OnlyTheBaseDriverConfirmsAStop) {
  sender_.stop(now_);
  sender_.take(sent().front());  // the bus delivers it to us, too
  sender_.take(message(true, "somebody"));
  EXPECT_FALSE(sender_.confirmed_by());
  sender_.take(message(true, confirmed_name("me")));
  EXPECT_EQ(sender_.confirmed_by(), "nodmap-kurt, for me");
  pass_a_second();
  EXPECT_TRUE(sender_.confirmed_by()) << "repeating it does not change that";
  sender_.stop(now_);
  EXPECT_FALSE(sender_.confirmed_by()) << "it was for the former one";
}

TEST_F(StopSenderTest, AConfirmationHoldsUntilSomebodyReleasesTheRobot) {
  sender_.stop(now_);
  sender_.take(message(true, confirmed_name("me")));
  sender_.take(message(false, "somebody", kStart + 1s));
  EXPECT_FALSE(sender_.confirmed_by());
}

// The base driver may repeat that it is stopped until it has received a copy.
TEST_F(StopSenderTest, WhetherTheRobotIsStillStoppedAfterAReleaseCountsFromItsLastCopy) {
  sender_.release(now_);
  sender_.take(message(true, confirmed_name("its start")));
  pass_a_second();
  EXPECT_TRUE(sender_.is_sent());
  EXPECT_FALSE(sender_.confirmed_by());
  sender_.take(message(true, confirmed_name("a bumper")));
  EXPECT_EQ(sender_.confirmed_by(), "nodmap-kurt, for a bumper");
}

TEST_F(StopSenderTest, AClockThatIsSetBackDoesNotSilenceIt) {
  sender_.stop(now_);
  sender_.repeat_if_due(kStart - 3600s);
  EXPECT_EQ(sent().size(), 2U);
}

}  // namespace stop_sender_test
}  // namespace nodmap::node
