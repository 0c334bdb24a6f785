// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/fleet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <limits>

#include "procman/protocol/test/fleet_fixture.hpp"

namespace nodmap::procman {
namespace fleet_test {

using FleetTest = test::FleetTest;

TEST_F(FleetTest, SendsNoOrdersToADeputyBeforeItsFirstInfo) {
  EXPECT_FALSE(fleet_.orders_for("h", {}).has_value());
  EXPECT_EQ(state("a"), "Unknown");
  report({});
  const auto orders = fleet_.orders_for("h", time::Timestamp(42us));
  ASSERT_TRUE(orders.has_value());
  EXPECT_EQ(orders->stamp, time::Timestamp(42us));
  EXPECT_EQ(orders->deputy_id, "h");
  EXPECT_EQ(orders->sheriff_id, "me:1:1000");
  EXPECT_EQ(orders->commands.size(), 2U) << "the commands of this host";
  EXPECT_EQ(order("a").desired_run, 0);
  EXPECT_EQ(state("a"), "Stopped (OK)");
}

TEST_F(FleetTest, AnEditedConfigurationAffectsOnlyChangedCommands) {
  report({status("a", 7, 1), status("r", 8, 1)});
  const Config edited = parse_config(R"(
      cmd "new" { exec = "n"; host = "h"; }
      cmd "r" { exec = "y --faster"; host = "h"; auto_respawn = "true"; }
      cmd "far" { exec = "z"; host = "other"; })")
                            .config;
  EXPECT_THAT(fleet_.reconfigure(edited),
              ::testing::UnorderedElementsAre("new is new", "r has changed",
                                              "a is no longer configured: stopping it"));
  EXPECT_TRUE(order("a").force_quit);
  EXPECT_EQ(order("r").desired_run, 2) << "restarted";
  EXPECT_EQ(order("r").spec.exec, "y --faster");
  EXPECT_EQ(order("new").desired_run, 0) << "not started yet";
  EXPECT_EQ(fleet_.items().front().spec.id, "new") << "in the order of the file";
  EXPECT_THAT(fleet_.reconfigure(edited), ::testing::IsEmpty());
  EXPECT_EQ(order("r").desired_run, 2);
}

// An edit does not start a stopped command; moving a command to another host stops it on the first.
TEST_F(FleetTest, AnEditOfTheConfigurationStartsNoCommand) {
  report({status("a", 0, 0), status("r", 8, 1)});
  const Config edited = parse_config(R"(
      cmd "a" { exec = "x --new"; host = "h"; }
      cmd "r" { exec = "y"; host = "other"; })")
                            .config;
  (void)fleet_.reconfigure(edited);
  EXPECT_EQ(order("a").desired_run, 0);
  EXPECT_TRUE(order("r").force_quit);
  report({}, "other");
  EXPECT_EQ(fleet_.orders_for("other", {})->commands.front().desired_run, 0);
}

// Two base drivers, or two navigators, must not run at the same time.
TEST_F(FleetTest, ACommandMovedToAnotherHostStartsOnlyWhenTheFirstHasEndedIt) {
  report({status("a", 7, 1), status("r", 8, 1)});
  report({}, "other");
  (void)fleet_.reconfigure(parse_config(R"(
      cmd "a" { exec = "x"; host = "other"; }
      cmd "r" { exec = "y"; host = "h"; auto_respawn = "true"; })")
                               .config);
  const auto order_there = [this] { return fleet_.orders_for("other", {})->commands.front(); };
  fleet_.start("a");
  report({status("a", 7, 1), status("r", 8, 1)});
  report({}, "other");
  EXPECT_TRUE(order("a").force_quit);
  EXPECT_TRUE(order_there().force_quit);
  EXPECT_FALSE(fleet_.is_stopped("a", now_));
  EXPECT_EQ(state("a"), "Stopping (Command Sent)");
  report({status("a", 0, 1, SIGINT), status("r", 8, 1)});
  EXPECT_FALSE(order_there().force_quit);
  EXPECT_EQ(order_there().desired_run, 1);
  EXPECT_EQ(state("a"), "Starting (Command Sent)");
  report({status("a", 9, 1)}, "other");
  EXPECT_EQ(state("a"), "Running");
  EXPECT_EQ(order("r").force_quit, false) << "the other command is left alone";
}

// The host may be broken: that is a reason to move the command.
TEST_F(FleetTest, AMovedCommandDoesNotWaitForAHostThatNoLongerReports) {
  report({status("a", 7, 1)});
  (void)fleet_.reconfigure(parse_config(R"(cmd "a" { exec = "x"; host = "other"; })").config);
  report({}, "other");
  fleet_.start("a");
  EXPECT_TRUE(fleet_.orders_for("other", {})->commands.front().force_quit);
  now_ += DeputyReports::kMaxInfoAge + 1s;
  report({}, "other");
  EXPECT_FALSE(fleet_.orders_for("other", {})->commands.front().force_quit);
  EXPECT_EQ(state("a"), "Starting (Command Sent)");
}

TEST_F(FleetTest, StartsRestartsAndStops) {
  report({});
  fleet_.start("a");
  fleet_.start("a");
  EXPECT_EQ(order("a").desired_run, 1) << "the start under way is not repeated";
  EXPECT_EQ(state("a"), "Starting (Command Sent)");
  report({status("a", 7, 1)});
  EXPECT_EQ(state("a"), "Running");
  fleet_.start("a");
  EXPECT_EQ(order("a").desired_run, 1) << "it runs already";
  fleet_.restart("a");
  EXPECT_EQ(order("a").desired_run, 2);
  EXPECT_EQ(state("a"), "Restarting (Command Sent)");
  EXPECT_TRUE(report({status("a", 0, 1, SIGINT)}))
      << "the order that starts it must be sent at once";
  EXPECT_EQ(state("a"), "Starting (Command Sent)");
  EXPECT_FALSE(report({status("a", 8, 2)}));
  EXPECT_EQ(fleet_.find("a")->num_restarts, 1);
  fleet_.stop("a");
  EXPECT_TRUE(order("a").force_quit);
  EXPECT_EQ(state("a"), "Stopping (Command Sent)");
  report({status("a", 0, 2, SIGINT)});
  EXPECT_EQ(state("a"), "Stopped (OK)");
  fleet_.start("a");
  EXPECT_EQ(order("a").desired_run, 3);
  EXPECT_FALSE(order("a").force_quit);
}

TEST_F(FleetTest, ACommandThatEndsByItselfIsNotStartedAgain) {
  report({});
  fleet_.start("a");
  report({status("a", 7, 1)});
  report({status("a", 0, 1, 3 << 8)});
  EXPECT_EQ(state("a"), "Stopped (Error)");
  EXPECT_TRUE(order("a").force_quit);
  fleet_.start("a");
  report({status("a", 0, 2, 0)});  // it ended before an INFO could report it
  EXPECT_EQ(state("a"), "Stopped (OK)");
  EXPECT_TRUE(order("a").force_quit);
}

TEST_F(FleetTest, ACommandKilledByNobodysOrderIsAnError) {
  report({});
  fleet_.start("a");
  report({status("a", 7, 1)});
  report({status("a", 0, 1, SIGKILL)});
  EXPECT_EQ(state("a"), "Stopped (Error)");
}

TEST_F(FleetTest, ARespawningCommandStaysWanted) {
  report({});
  fleet_.start("r");
  report({status("r", 7, 1)});
  report({status("r", 0, 1, SIGSEGV)});
  EXPECT_FALSE(order("r").force_quit);
  report({status("r", 8, 1)});
  EXPECT_EQ(state("r"), "Running");
  EXPECT_EQ(fleet_.find("r")->num_restarts, 1);
}

TEST_F(FleetTest, TheGreatestRunNumberIsFollowedByOne) {
  constexpr int kLast = std::numeric_limits<std::int32_t>::max();
  fleet_.start("r");
  report({status("a", 7, kLast), status("r", 0, kLast)});
  fleet_.restart("a");
  EXPECT_EQ(order("a").desired_run, 1);
  EXPECT_EQ(order("r").desired_run, 1);
}

TEST_F(FleetTest, TheNumberOfUnknownHostsAndCommandsIsLimited) {
  for (int i = 0; i < 300; ++i) {
    std::vector<CommandStatus> commands;
    for (int k = 0; k < 100; ++k) {
      commands.push_back(status(std::to_string(100 * i + k), 1, 1));
    }
    report(std::move(commands), std::to_string(i));
  }
  EXPECT_LE(fleet_.items().size(), 10'000U);
  EXPECT_FALSE(fleet_.orders_for("299", {}).has_value());
}

TEST_F(FleetTest, AStartBeforeTheFirstInfoContinuesItsRunNumbers) {
  fleet_.start("a");
  fleet_.start("r");
  report({status("a", 7, 5), status("r", 0, 3)});
  EXPECT_EQ(order("a").desired_run, 5) << "it runs already";
  EXPECT_EQ(order("r").desired_run, 4);
  EXPECT_FALSE(order("r").force_quit);
}

TEST_F(FleetTest, ARestartedDeputyIsToldToStartWhatRan) {
  report({});
  fleet_.start("a");
  report({status("a", 7, 1)});
  report({});
  EXPECT_EQ(order("a").desired_run, 1);
  EXPECT_FALSE(order("a").force_quit);
  EXPECT_EQ(state("a"), "Starting (Command Sent)");
}

TEST_F(FleetTest, CommandsOfASilentHostAreUnknown) {
  report({status("a", 7, 1)});
  now_ += DeputyReports::kMaxInfoAge;
  EXPECT_EQ(state("a"), "Running");
  now_ += 1us;
  EXPECT_EQ(state("a"), "Unknown");
  EXPECT_FALSE(fleet_.is_stopped("a", now_));
}

TEST_F(FleetTest, ACommandOfTheSameNameOnAnotherHostIsIgnored) {
  report({status("a", 7, 1)}, "other");
  EXPECT_EQ(state("a"), "Unknown");
}

TEST_F(FleetTest, IgnoresHostsThatAreNotInTheConfiguration) {
  report({status("b", 7, 1)}, "stranger");
  EXPECT_FALSE(fleet_.orders_for("stranger", {}).has_value());
  receive_orders("you:2:1", "stranger");
  EXPECT_FALSE(other_sheriff()) << "its sheriff does not concern us";
}

TEST_F(FleetTest, NoticesAnotherSheriffAndYieldsToTheOlderOne) {
  receive_orders("me:1:1000");
  EXPECT_FALSE(other_sheriff()) << "that is us";
  receive_orders("you:2:999");
  EXPECT_EQ(other_sheriff(), "you:2:999");
  EXPECT_TRUE(fleet_.must_yield(now_)) << "it was there first";
  receive_orders("you:2:1001");
  EXPECT_FALSE(fleet_.must_yield(now_));
  receive_orders("who");
  EXPECT_TRUE(fleet_.must_yield(now_));
  now_ += OtherSheriffs::kSilence + 1us;
  EXPECT_FALSE(fleet_.must_yield(now_));
}

// It reports that nothing runs.
TEST_F(FleetTest, AForgedInfoIsNotBelievedWhileTheDeputyReports) {
  const bus::Sender own{0x7F000001, 40'000};
  const bus::Sender other{0x7F000001, 40'001};
  DeputyInfo info;
  info.deputy_id = "h";
  info.commands = {status("a", 10, 1)};
  DeputyInfo forged = info;
  forged.commands = {status("a", 0, 1)};
  for (int s = 0; s < 10; ++s, now_ += 1s) {
    fleet_.take_info(info, now_, own);
    fleet_.take_info(forged, now_ + 500ms, other);
    fleet_.take_runs({{}, "h", {{"a", 10, 0s, 99}}}, now_ + 500ms, other);
    EXPECT_EQ(fleet_.state_of("a", now_ + 500ms), CommandState::kRunning);
    EXPECT_EQ(Fleet::run_of(*fleet_.find("a")).num_restarts, 0);
    EXPECT_EQ(fleet_.deputies().sender_of("h", now_), own);
    EXPECT_EQ(fleet_.deputies().contested(now_).size(), s == 0 ? 0U : 1U)
        << "known when the deputy continues";
  }
  // The deputy has been started again.
  now_ += DeputyReports::kSilence;
  fleet_.take_info(forged, now_, other);
  EXPECT_NE(fleet_.state_of("a", now_), CommandState::kRunning);
  EXPECT_TRUE(fleet_.deputies().contested(now_ + DeputyReports::kSilence).empty());
}

// Anybody can send one message.
TEST_F(FleetTest, ASheriffDoesNotYieldToOneOrder) {
  fleet_.take_command(now_);
  for (std::uint16_t port = 1; port < 10; ++port, now_ += 1s) {
    fleet_.take_orders({{}, "h", "you:2:1", {}}, now_, {0x7F000001, port});
    EXPECT_FALSE(fleet_.must_yield(now_));
  }
}

// A message with an old id can come from anybody.
TEST_F(FleetTest, ASheriffThatHasGivenOrdersForLongDoesNotYield) {
  fleet_.take_command(now_);
  receive_orders("you:2:1");
  EXPECT_TRUE(fleet_.must_yield(now_));
  now_ += Fleet::kYieldTime;
  receive_orders("you:2:1");
  EXPECT_EQ(other_sheriff(), "you:2:1");
  EXPECT_FALSE(fleet_.must_yield(now_));
}

TEST_F(FleetTest, TheAgeOfARunIsThatReportedByItsDeputy) {
  report({status("a", 10, 1)});
  const auto run = [this] { return Fleet::run_of(*fleet_.find("a")); };
  EXPECT_EQ(run().started, now_) << "when this sheriff first received it";
  fleet_.take_runs({{}, "h", {{"a", 10, 3600s, 4}, {"unknown", 1, 1s, 1}}}, now_);
  EXPECT_EQ(run().started, now_ - 3600s);
  EXPECT_EQ(run().num_restarts, 4);
  fleet_.take_runs({{}, "elsewhere", {{"a", 10, 1s, 9}}}, now_);
  EXPECT_EQ(run().num_restarts, 4) << "another deputy's report does not count";
  // The next process is a new run, of which nothing more is known until its deputy reports it.
  now_ += 1s;
  report({status("a", 11, 1)});
  EXPECT_EQ(run().started, now_);
  fleet_.take_runs({{}, "h", {{"a", 11, 0s, 5}}}, now_);
  EXPECT_EQ(run().num_restarts, 5);
}

}  // namespace fleet_test
}  // namespace nodmap::procman
