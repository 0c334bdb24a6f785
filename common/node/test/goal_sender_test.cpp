// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/goal_sender.hpp"

#include <gtest/gtest.h>

#include "tests/support/memory_bus.hpp"

namespace nodmap::node {
namespace goal_sender_test {

using Status = GoalSender::Status;

constexpr time::Timestamp kStart{1'700'000'000s};

nodmap::goal_t goal_at(double x_m) {
  nodmap::goal_t goal{};
  goal.position_m[0] = x_m;
  goal.tolerance_m = 0.2;
  return goal;
}

class GoalSenderTest : public testing::Test {
 protected:
  [[nodiscard]] nodmap::goal_t last() const { return bus_.last<nodmap::goal_t>("GOAL"); }
  // The navigator's report on a goal, `passed` after the start.
  bool report(std::int64_t goal_utime, time::Duration passed) {
    nodmap::navigation_t message{};
    message.utime = time::to_utime(kStart + passed);
    message.goal_utime = goal_utime;
    return sender_.take(message);
  }

  test::MemoryBus bus_;
  GoalSender sender_{bus_};
};

TEST_F(GoalSenderTest, RepeatsTheGoalOnceASecond) {
  sender_.repeat_if_due(kStart);
  EXPECT_EQ(bus_.count("GOAL"), 0U) << "there is no goal yet";
  sender_.set(goal_at(1.0), kStart);
  EXPECT_EQ(last().utime, time::to_utime(kStart));
  EXPECT_EQ(last().is_active, 1);
  for (time::Duration passed{}; passed <= 3s; passed += 100ms) {
    sender_.repeat_if_due(kStart + passed);
  }
  const auto sent = bus_.sent<nodmap::goal_t>("GOAL");
  ASSERT_EQ(sent.size(), 4U);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].goal_seq, static_cast<std::int64_t>(i));
    EXPECT_EQ(sent[i].utime, time::to_utime(kStart)) << "the time at which it was set";
    EXPECT_EQ(sent[i].position_m[0], 1.0);
  }
  EXPECT_EQ(sender_.num_published(), 4);
}

// A report on the former goal must not count for the new one.
TEST_F(GoalSenderTest, EachGoalHasATimeOfItsOwnAlsoWhenTheClockIsSetBack) {
  EXPECT_FALSE(sender_.is_about(0)) << "of a navigator without a goal";
  sender_.set(goal_at(1.0), kStart);
  const nodmap::goal_t former = last();
  for (const time::Timestamp now : {kStart, kStart - 10s, kStart + 1us}) {
    sender_.set(goal_at(2.0), now);
    EXPECT_GT(last().utime, former.utime);
    EXPECT_TRUE(sender_.is_about(last().utime));
    EXPECT_FALSE(sender_.is_about(former.utime));
  }
}

TEST_F(GoalSenderTest, AClockThatIsSetBackSilencesItForNoLongerThanTwoPeriods) {
  sender_.set(goal_at(1.0), kStart);
  sender_.repeat_if_due(kStart - 500ms);
  EXPECT_EQ(bus_.count("GOAL"), 1U);
  sender_.repeat_if_due(kStart + 1s);
  EXPECT_EQ(bus_.count("GOAL"), 2U);
  sender_.repeat_if_due(kStart - 3600s);
  EXPECT_EQ(bus_.count("GOAL"), 3U);
}

// The bus delivers own messages after the next goal was set, too.
TEST_F(GoalSenderTest, OnlyAGoalOfAnotherSenderOverrulesIt) {
  sender_.set(goal_at(1.0), kStart);
  const nodmap::goal_t former = last();
  sender_.set(goal_at(2.0), kStart + 1s);
  sender_.repeat_if_due(kStart + 2s);
  EXPECT_FALSE(sender_.take(former));
  EXPECT_FALSE(sender_.take(last()));
  EXPECT_EQ(sender_.status(), Status::kSent);
  nodmap::goal_t elsewhere = last();
  elsewhere.position_m[1] = 0.1;
  nodmap::goal_t cancelled = last();
  cancelled.is_active = 0;
  nodmap::goal_t later = last();
  ++later.utime;
  for (const nodmap::goal_t& foreign : {elsewhere, cancelled, later}) {
    sender_.set(goal_at(2.0), kStart + 3s);
    EXPECT_TRUE(sender_.take(foreign));
    EXPECT_EQ(sender_.status(), Status::kOverruled);
    const std::size_t num_published = bus_.count("GOAL");
    sender_.repeat_if_due(kStart + 10s);
    EXPECT_EQ(bus_.count("GOAL"), num_published) << "it was overruled";
  }
}

TEST_F(GoalSenderTest, WithoutAGoalNobodyOverrulesIt) {
  EXPECT_TRUE(sender_.take(goal_at(1.0)));
  EXPECT_EQ(sender_.status(), Status::kNone);
}

TEST_F(GoalSenderTest, KnowsFromReportsWhetherTheNavigatorHasTheGoal) {
  sender_.set(goal_at(1.0), kStart);
  const std::int64_t former = last().utime;
  EXPECT_TRUE(report(former, 100ms));
  EXPECT_EQ(sender_.status(), Status::kTaken);
  sender_.set(goal_at(2.0), kStart + 200ms);
  EXPECT_FALSE(report(former, 300ms));
  EXPECT_EQ(sender_.status(), Status::kSent) << "it has not received it yet";
  const std::int64_t present = last().utime;
  EXPECT_TRUE(report(present, 400ms));
  EXPECT_FALSE(report(0, 500ms));
  EXPECT_EQ(sender_.status(), Status::kLeft) << "somebody has cancelled it";
  EXPECT_TRUE(report(present, 600ms));
  EXPECT_EQ(sender_.status(), Status::kTaken) << "it was repeated";
  nodmap::goal_t foreign = goal_at(3.0);
  sender_.take(foreign);
  EXPECT_TRUE(report(present, 700ms));
  EXPECT_EQ(sender_.status(), Status::kOverruled) << "it has not received the other yet";
}

TEST_F(GoalSenderTest, ACancellationIsRepeatedUntilTheNavigatorHasNoGoal) {
  sender_.set(goal_at(1.0), kStart);
  const std::int64_t former = last().utime;
  EXPECT_TRUE(report(former, 100ms));
  sender_.cancel(kStart + 200ms);
  EXPECT_EQ(last().is_active, 0);
  EXPECT_GT(last().utime, former);
  EXPECT_FALSE(report(former, 300ms));
  EXPECT_EQ(sender_.status(), Status::kSent) << "it has not received it yet";
  sender_.repeat_if_due(kStart + 1200ms);
  EXPECT_EQ(bus_.count("GOAL"), 3U);
  EXPECT_FALSE(sender_.take(last())) << "our own";
  EXPECT_TRUE(report(0, 1250ms));
  EXPECT_EQ(sender_.status(), Status::kTaken);
  EXPECT_FALSE(report(former, 1400ms));
  EXPECT_EQ(sender_.status(), Status::kLeft);
  sender_.set(goal_at(2.0), kStart + 2s);
  EXPECT_FALSE(sender_.is_about(0));
}

TEST_F(GoalSenderTest, ANavigatorThatWasSilentMayHaveBeenStartedAnew) {
  sender_.set(goal_at(1.0), kStart);
  EXPECT_TRUE(report(last().utime, 100ms));
  EXPECT_FALSE(report(0, 2s));
  EXPECT_EQ(sender_.status(), Status::kSent);
  EXPECT_TRUE(report(last().utime, 2100ms));
  EXPECT_EQ(sender_.status(), Status::kTaken);
}

}  // namespace goal_sender_test
}  // namespace nodmap::node
