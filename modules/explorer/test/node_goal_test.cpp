// SPDX-License-Identifier: BSD-3-Clause
// Which goal the robot has when an exploration starts and after it has ended.
#include <gtest/gtest.h>

#include "modules/explorer/test/explorer_node_fixture.hpp"

namespace nodmap::explorer {
namespace node_goal_test {

using test::ExplorerNodeTest;

TEST_F(ExplorerNodeTest, EndedByTheUserItLeavesTheRobotWhereItIs) {
  give_map();
  ask(true);
  (void)give_pose();
  ask(false);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  EXPECT_TRUE(goal.is_active);
  EXPECT_EQ(goal.position_m[0], 0.0);
  const auto exploration = give_pose();
  EXPECT_EQ(exploration.state, nodmap::exploration_t::IDLE);
  EXPECT_EQ(exploration.reason, "Ended by somebody.");
}

// It has driven 2 m since the last pose of 2D SLAM, 6 s ago.
TEST_F(ExplorerNodeTest, EndedByTheUserItLeavesTheRobotWhereItIsByTheNewestOdometry) {
  give_map();
  ask(true);
  (void)give_pose();
  utime_us_ += 6'000'000;
  give_odometry(2.0);
  ask(false);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 2.0);
}

// A navigator that is started later would roam without a goal.
TEST_F(ExplorerNodeTest, AfterItsEndTheGoalIsRepeatedUntilTheNavigatorHasIt) {
  give_map();
  ask(true);
  (void)give_pose();
  ask(false);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  std::size_t num_goals = bus_.count("GOAL");
  for (int i = 0; i < 4; ++i) {
    (void)give_pose();
  }
  EXPECT_EQ(bus_.count("GOAL"), num_goals + 2) << "in two seconds";
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").utime, goal.utime) << "it is the same goal";
  const auto count_repetitions = [&](std::int64_t goal_utime) {
    num_goals = bus_.count("GOAL");
    for (int i = 0; i < 4; ++i) {
      nodmap::navigation_t navigation{};
      navigation.utime = utime_us_;
      navigation.goal_utime = goal_utime;
      bus_.deliver("NAVIGATION", navigation);
      (void)give_pose();
    }
    return bus_.count("GOAL") - num_goals;
  };
  EXPECT_EQ(count_repetitions(goal.utime), 0U) << "the navigator has taken it";
  utime_us_ += 5'000'000;
  EXPECT_EQ(count_repetitions(0), 2U) << "a navigator that was silent has no goal";
  EXPECT_EQ(count_repetitions(goal.utime), 0U);
  EXPECT_EQ(count_repetitions(0), 0U) << "somebody has cancelled it";
  utime_us_ += 5'000'000;
  EXPECT_EQ(count_repetitions(0), 0U);
}

TEST_F(ExplorerNodeTest, AfterItsEndTheGoalOfAnotherSenderIsNotOverruled) {
  give_map();
  ask(true);
  (void)give_pose();
  ask(false);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  auto others = goal;
  others.position_m[0] += 1.0;
  bus_.deliver("GOAL", others);
  const std::size_t num_goals = bus_.count("GOAL");
  for (int i = 0; i < 4; ++i) {
    (void)give_pose();
  }
  EXPECT_EQ(bus_.count("GOAL"), num_goals);
}

// The kept place is a position in a map that no longer exists.
TEST_F(ExplorerNodeTest, ANewMapAfterItsEndRenewsThePlaceWhereTheRobotIs) {
  give_map(7);
  ask(true);
  (void)give_pose();
  ask(false);
  give_map(0);
  give_map(1);  // the first one alone may be a late tile
  utime_us_ += 300'000;
  give_odometry(1.5);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 1.5);
}

// The same coordinates are another place in the new map, and the navigator has dropped the goal.
TEST_F(ExplorerNodeTest, ANewMapRenewsThePlaceAlsoOfARobotThatHasNotMoved) {
  give_map(7);
  ask(true);
  (void)give_pose();
  ask(false);
  for (int i = 0; i < 2; ++i) {
    const auto goal = bus_.last<nodmap::goal_t>("GOAL");
    give_map(7);
    give_map(0);
    give_map(1);  // the first one alone may be a late tile
    utime_us_ += 300'000;
    give_odometry(0.0);
    const auto renewed = bus_.last<nodmap::goal_t>("GOAL");
    EXPECT_NE(renewed.utime, goal.utime) << i;
    EXPECT_EQ(renewed.position_m[0], 0.0);
  }
}

// A patrol repeats its goal once a second, until it sees that it has been overruled.
TEST_F(ExplorerNodeTest, AGoalThatIsOlderThanTheExplorationDoesNotEndIt) {
  give_map();
  nodmap::goal_t patrol{};
  patrol.utime = 1;
  patrol.is_active = 1;
  patrol.position_m[0] = 3.0;
  bus_.deliver("GOAL", patrol);
  ask(true);
  bus_.deliver("GOAL", patrol);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
  EXPECT_EQ(bus_.count("GOAL"), 1U) << "overrules the patrol";
  bus_.deliver("GOAL", patrol);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::IDLE) << "it has overruled the explorer";
}

TEST_F(ExplorerNodeTest, AnotherGoalEndsTheExplorationAlsoBeforeItsFirstGoal) {
  give_map();
  nodmap::goal_t goal{};
  goal.utime = 1;
  goal.is_active = 1;
  bus_.deliver("GOAL", goal);
  ask(true);
  goal.utime = 2;
  bus_.deliver("GOAL", goal);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::IDLE);
  EXPECT_EQ(bus_.count("GOAL"), 0U);
}

// The robot is stopped, and somebody moves it before it is released.
TEST_F(ExplorerNodeTest, HomeIsWhereTheRobotWasWhenItWasAskedToExplore) {
  see_everything();
  give_map();
  (void)give_pose();
  stop(true);
  ask(true);
  utime_us_ += 500'000;
  give_odometry(1.0);
  stop(false);
  utime_us_ += 500'000;
  give_odometry(1.0);
  EXPECT_EQ(bus_.last<nodmap::exploration_t>("EXPLORATION").state,
            nodmap::exploration_t::RETURNING);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 0.0);
}

TEST_F(ExplorerNodeTest, HomeIsNotWhereTheRobotWasInAMapThatNoLongerExists) {
  see_everything();
  give_map(7);
  (void)give_pose();
  stop(true);
  ask(true);
  give_map(0);
  give_map(1);  // the first one alone may be a late tile
  utime_us_ += 500'000;
  give_odometry(1.0);
  stop(false);
  utime_us_ += 500'000;
  give_odometry(1.0);
  EXPECT_EQ(bus_.last<nodmap::exploration_t>("EXPLORATION").state, nodmap::exploration_t::HOME);
}

// Who asks for an exploration of what is known already must see that it has been started.
TEST_F(ExplorerNodeTest, SaysThatItStartsBeforeTheFirstDecisionEndsIt) {
  see_everything();
  give_map();
  (void)give_pose();
  ask(true);
  EXPECT_EQ(bus_.last<nodmap::exploration_t>("EXPLORATION").state,
            nodmap::exploration_t::EXPLORING);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::HOME);
}

// Meanwhile somebody may have moved the robot, which must not drive back.
TEST_F(ExplorerNodeTest, ThePlaceWhereItEndedIsRenewedWhenTheRobotIsReleased) {
  give_map();
  ask(true);
  (void)give_pose();
  stop(true);
  ask(false);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 0.0);
  utime_us_ += 300'000;
  give_odometry(1.5);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 0.0);
  stop(false);
  utime_us_ += 300'000;
  give_odometry(1.5);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 1.5);
}

TEST_F(ExplorerNodeTest, ANewMapEndsTheExplorationAndTheRobotStaysWhereItIs) {
  give_map(7);
  ask(true);
  (void)give_pose();
  give_map(8);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
  give_map(0);
  give_map(1);  // the first one alone may be a late tile
  const std::size_t num_goals = bus_.count("GOAL");
  EXPECT_EQ(give_pose().reason, "The 2D map was restarted.");
  // The old goal is a position in a map that no longer exists.
  ASSERT_EQ(bus_.count("GOAL"), num_goals + 1);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  EXPECT_TRUE(goal.is_active);
  EXPECT_EQ(goal.position_m[0], 0.0);
  EXPECT_EQ(goal.position_m[1], 0.0);
  (void)give_pose();
  EXPECT_EQ(bus_.count("GOAL"), num_goals + 1);
}

}  // namespace node_goal_test
}  // namespace nodmap::explorer
