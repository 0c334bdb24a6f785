// SPDX-License-Identifier: BSD-3-Clause
// Tests with an emulated deputy on a bus in memory.
#include "modules/viewer/process_control.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "common/bus/live_bus.hpp"
#include "procman/config/parser.hpp"
#include "procman/protocol/messages.hpp"

namespace nodmap::viewer {
namespace process_control_test {

using procman::DeputyInfo;
using procman::Orders;
using procman::Verb;

procman::Config config() {
  return procman::parse_config(R"(
    cmd "slam" { exec = "nodmap-slam2d"; host = "robot"; stop_time_allowed = 2; }
    cmd "log" { exec = "A=1 nodmap-logger --out x"; host = "robot"; })")
      .config;
}

class ProcessControlTest : public ::testing::Test {
 protected:
  ProcessControlTest() {
    bus_.subscribe<procman_lcm::orders_t>(procman::kOrdersChannel, [this](const auto& message) {
      orders_.push_back(procman::from_message(message));
    });
  }

  void handle() {
    while (bus_.handle(std::chrono::milliseconds(0)) > 0) {
    }
  }

  // The deputy reports that "slam" is in this run, and "other", which is not configured, in its
  // third.
  void tell(std::int32_t slam_run, bool slam_runs = true) {
    DeputyInfo info;
    info.deputy_id = "robot";
    info.commands.resize(2);
    info.commands[0].spec.id = "slam";
    info.commands[0].spec.exec = "nodmap-slam2d";
    info.commands[0].pid = slam_runs ? 100 + slam_run : 0;
    info.commands[0].actual_run = slam_run;
    info.commands[1].spec.id = "other";
    info.commands[1].pid = 7;
    info.commands[1].actual_run = 3;
    bus_.publish(procman::kInfoChannel, procman::to_message(info));
    handle();
  }

  void other_sheriff_orders() {
    bus_.publish(procman::kOrdersChannel, procman::to_message(Orders{{}, "robot", "far:1:1", {}}));
    handle();
    orders_.clear();
  }
  void other_sheriff_repeats_its_orders() {
    other_sheriff_orders();
    pass(procman::OtherSheriffs::kRepeated);
    other_sheriff_orders();
  }

  void pass(time::Duration duration) {
    now_.wall += duration;
    now_.steady += duration;
    control_.poll();
    handle();
  }

  // The newest order for a command.
  procman::CommandOrder ordered(const std::string& id) const {
    const auto& commands = orders_.back().commands;
    const auto found =
        std::ranges::find_if(commands, [&id](const auto& order) { return order.spec.id == id; });
    return found == commands.end() ? procman::CommandOrder{} : *found;
  }

  bus::LiveBus bus_{"memq://"};
  time::Moment now_{time::Timestamp(5'000s), time::SteadyTime(100s)};
  std::vector<Orders> orders_;
  ProcessControl control_{bus_, config(), [this] { return now_; }};
};

TEST_F(ProcessControlTest, KeepsTheLastLinesOfACommandsOutput) {
  EXPECT_EQ(control_.output("slam").text, "");
  const auto say = [this](const std::string& deputy, const std::string& command,
                          const std::string& text) {
    procman::Output output;
    output.deputy_id = deputy;
    output.outputs.push_back({command, text});
    bus_.publish(procman::kOutputChannel, procman::to_message(output));
    handle();
  };
  say("robot", "slam", "first\nsec");
  say("robot", "slam", "ond\n");
  say("elsewhere", "slam", "forged\n");
  say("robot", "nobody", "made up\n");
  EXPECT_TRUE(control_.output("slam").ok);
  EXPECT_EQ(control_.output("slam").text, "first\nsecond\n");
  EXPECT_EQ(control_.output("log").text, "");
  EXPECT_FALSE(control_.output("nobody").ok);
}

TEST_F(ProcessControlTest, OrdersARestartUntilItHasHappenedAndKeepsOtherCommandsRunning) {
  tell(4);
  EXPECT_TRUE(control_.change(Verb::kRestart, "slam").ok);
  handle();
  ASSERT_EQ(orders_.size(), 1U);
  EXPECT_EQ(orders_[0].deputy_id, "robot");
  EXPECT_EQ(ordered("slam").desired_run, 5);
  EXPECT_FALSE(ordered("slam").force_quit);
  // A command missing from the orders would be stopped.
  EXPECT_EQ(ordered("other").desired_run, 3);
  EXPECT_FALSE(ordered("other").force_quit);
  pass(1s);
  EXPECT_EQ(orders_.size(), 2U);
  tell(4, false);  // stopped: the orders that start it are sent at once
  EXPECT_EQ(orders_.size(), 3U);
  tell(5);
  pass(1us);
  EXPECT_FALSE(control_.is_sheriff());
  pass(5s);
  EXPECT_EQ(orders_.size(), 3U);
}

TEST_F(ProcessControlTest, StopsAndStartsACommand) {
  tell(4);
  EXPECT_TRUE(control_.change(Verb::kStop, "slam").ok);
  handle();
  EXPECT_TRUE(ordered("slam").force_quit);
  tell(4, false);
  pass(1us);
  EXPECT_FALSE(control_.is_sheriff());
  EXPECT_TRUE(control_.change(Verb::kStart, "slam").ok);
  handle();
  EXPECT_EQ(ordered("slam").desired_run, 5);
  EXPECT_FALSE(ordered("slam").force_quit);
}

// It begins with the present state, which another sheriff may have changed: with old orders it
// would start old runs again.
TEST_F(ProcessControlTest, BeginsWithTheStateThatTheDeputyReports) {
  tell(4);
  EXPECT_TRUE(control_.change(Verb::kRestart, "slam").ok);
  tell(5);
  pass(1us);
  other_sheriff_repeats_its_orders();
  tell(8);
  pass(4s);
  tell(8);
  EXPECT_TRUE(control_.change_recording(Verb::kStart).ok);
  handle();
  EXPECT_EQ(ordered("slam").desired_run, 8);
  EXPECT_EQ(ordered("log").desired_run, 1);
}

// With the old exec line the deputy, which reads the same file, would stop it and not start it.
TEST_F(ProcessControlTest, OrdersWhatTheEditedConfigurationSays) {
  tell(4);
  control_.set_config(procman::parse_config(R"(
    cmd "slam" { exec = "nodmap-slam2d --set x=1"; host = "robot"; })")
                          .config);
  EXPECT_TRUE(control_.change(Verb::kRestart, "slam").ok);
  handle();
  EXPECT_EQ(ordered("slam").spec.exec, "nodmap-slam2d --set x=1");
  EXPECT_EQ(ordered("slam").desired_run, 5);
  EXPECT_FALSE(control_.change(Verb::kStart, "log").ok) << "no longer configured";
}

TEST_F(ProcessControlTest, YieldsToAnotherSheriff) {
  tell(4);
  other_sheriff_orders();
  EXPECT_FALSE(control_.change(Verb::kStop, "slam").ok);
  pass(procman::OtherSheriffs::kSilence + 1us);
  EXPECT_TRUE(control_.change(Verb::kStop, "slam").ok);
  other_sheriff_orders();
  EXPECT_TRUE(control_.is_sheriff()) << "anybody can send one message";
  pass(procman::OtherSheriffs::kRepeated);
  other_sheriff_orders();
  EXPECT_FALSE(control_.is_sheriff());
}

TEST_F(ProcessControlTest, StopsBeingTheSheriffIfACommandDoesNotStart) {
  tell(4);
  EXPECT_TRUE(control_.change(Verb::kStop, "slam").ok);
  for (int i = 0; i < 11; ++i) {
    pass(1s);
    tell(4);
    EXPECT_TRUE(control_.is_sheriff());
  }
  pass(1s);  // ten seconds and the grace time
  EXPECT_FALSE(control_.is_sheriff());
}

TEST_F(ProcessControlTest, RefusesCommandsThatAreNotConfiguredOrNotHeardOf) {
  EXPECT_FALSE(control_.change(Verb::kStart, "slam").ok);  // no INFO of its deputy was received
  tell(4);
  EXPECT_FALSE(control_.change(Verb::kStart, "slam6d").ok);
  EXPECT_FALSE(control_.change(Verb::kStart, "").ok);
  EXPECT_FALSE(control_.change(Verb::kStart, "other").ok);  // not in the configuration
  pass(procman::DeputyReports::kMaxInfoAge + 1us);
  EXPECT_FALSE(control_.change(Verb::kStart, "slam").ok);
  EXPECT_TRUE(orders_.empty());
}

}  // namespace process_control_test
}  // namespace nodmap::viewer
