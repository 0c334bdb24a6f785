// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <csignal>

#include "procman/protocol/test/fleet_fixture.hpp"

namespace nodmap::procman {
namespace fleet_takeover_test {

class FleetTakeoverTest : public test::FleetTest {
 protected:
  // The third run of a command that is started again whenever it ends has ended.
  static CommandStatus ended(int wait_status) {
    CommandStatus made = status("r", 0, 3, wait_status);
    made.spec.auto_respawn = true;
    return made;
  }
};

TEST_F(FleetTakeoverTest, TakesOverTheCommandsOfADeputyAsTheyAre) {
  report({status("a", 7, 5), ended(SIGINT), status("unheard-of", 9, 2)});
  EXPECT_EQ(order("a").desired_run, 5);
  EXPECT_FALSE(order("a").force_quit);
  EXPECT_EQ(order("r").desired_run, 3);
  EXPECT_TRUE(order("r").force_quit);
  EXPECT_EQ(state("r"), "Stopped (OK)") << "it is not known who stopped it";
  EXPECT_EQ(order("unheard-of").desired_run, 2)
      << "a command left out of the orders would be stopped";
}

// A command that ends at once is between two runs most of the time.
TEST_F(FleetTakeoverTest, ACommandTakenOverBetweenTwoRunsIsStartedAgain) {
  const CommandStatus down = ended(1 << 8);
  report({down});
  EXPECT_FALSE(order("r").force_quit) << "it would never be started again";
  EXPECT_EQ(order("r").desired_run, 3);
  EXPECT_EQ(state("r"), "Stopped (Error)");
  now_ += 1s;
  report({status("r", 8, 3)});
  EXPECT_EQ(state("r"), "Running");
  now_ += Fleet::kRespawnTime + 1us;
  report({ended(SIGTERM)});
  EXPECT_FALSE(order("r").force_quit);
  EXPECT_EQ(state("r"), "Stopped (Error)") << "nobody has stopped it";
}

// Some programs end with an error when they are stopped. A restarted deputy must not start them.
TEST_F(FleetTakeoverTest, ACommandTakenOverThatDoesNotRunAgainInTimeWasStopped) {
  const CommandStatus down = ended(1 << 8);
  report({down});
  now_ += Fleet::kRespawnTime;
  report({down});
  EXPECT_FALSE(order("r").force_quit);
  now_ += 1us;
  report({down});
  EXPECT_TRUE(order("r").force_quit);
  fleet_.start("r");
  report({down});
  EXPECT_FALSE(order("r").force_quit) << "an order counts for longer";
}

// Another sheriff starts, stops and restarts them.
TEST_F(FleetTakeoverTest, WithoutCommandItShowsWhatTheDeputyReports) {
  fleet_.observe();
  report({status("a", 0, 0), status("r", 7, 1)});
  EXPECT_EQ(state("a"), "Stopped (OK)");
  EXPECT_EQ(state("r"), "Running");
  report({status("a", 8, 1), status("r", 0, 1, SIGINT)});
  EXPECT_EQ(state("a"), "Running");
  EXPECT_EQ(state("r"), "Stopped (OK)") << "it is not known who stopped it";
  report({status("a", 0, 1, 3 << 8), status("r", 9, 2)});
  EXPECT_EQ(state("a"), "Stopped (Error)");
  EXPECT_EQ(state("r"), "Running");
  report({status("a", 10, 2), status("r", 11, 3)});
  EXPECT_EQ(state("a"), "Running");
  EXPECT_EQ(state("r"), "Running") << "restarted, which no INFO has reported";
  report({});
  EXPECT_EQ(state("a"), "Stopped (OK)")
      << "the deputy was started again, and nobody has ordered it";
}

// While another sheriff had the command, it has started one command, restarted another and stopped
// a third.
TEST_F(FleetTakeoverTest, ASheriffThatTakesCommandAgainKeepsWhatRunsByThen) {
  report({status("a", 0, 1), status("r", 7, 1), status("other", 9, 3)});
  fleet_.stop("r");
  fleet_.observe();
  report({status("a", 8, 2), status("r", 10, 2), status("other", 0, 3, SIGINT)});
  fleet_.take_command(now_);
  EXPECT_EQ(order("a").desired_run, 2);
  EXPECT_FALSE(order("a").force_quit);
  EXPECT_EQ(order("r").desired_run, 2);
  EXPECT_FALSE(order("r").force_quit) << "the stop was ordered before";
  EXPECT_EQ(order("other").desired_run, 3);
  EXPECT_TRUE(order("other").force_quit);
  report({status("a", 8, 2), status("r", 10, 2), status("other", 0, 3, SIGINT)});
  EXPECT_FALSE(order("a").force_quit);
  EXPECT_FALSE(order("r").force_quit);
}

// It has seen for how long the command was down.
TEST_F(FleetTakeoverTest, ACommandThatWasDownForLongBeforeTheTakeoverWasStopped) {
  const CommandStatus down = ended(1 << 8);
  fleet_.observe();
  report({down});
  now_ += Fleet::kRespawnTime;
  report({down});
  EXPECT_FALSE(order("r").force_quit);
  now_ += 1us;
  report({down});
  fleet_.take_command(now_);
  EXPECT_TRUE(order("r").force_quit);
}

}  // namespace fleet_takeover_test
}  // namespace nodmap::procman
