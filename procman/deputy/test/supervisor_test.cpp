// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/supervisor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <limits>

#include "common/bus/codec.hpp"
#include "procman/protocol/messages.hpp"

namespace nodmap::procman {
namespace supervisor_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kExit3 = 3 << 8;

// The actions as text, without PublishInfo.
std::vector<std::string> words(const SupervisorActions& actions) {
  std::vector<std::string> all;
  for (const SupervisorAction& action : actions) {
    if (const auto* start = std::get_if<StartCommand>(&action)) {
      all.push_back("start " + start->id + ": " + start->exec);
    } else if (const auto* signal = std::get_if<SignalCommand>(&action)) {
      all.push_back("signal " + signal->id + " " + std::to_string(signal->signal));
    } else if (const auto* say = std::get_if<WriteOutput>(&action)) {
      all.push_back("say " + say->id + ": " + say->text);
    } else if (const auto* forget = std::get_if<ForgetCommand>(&action)) {
      all.push_back("forget " + forget->id);
    }
  }
  return all;
}

bool tells(const SupervisorActions& actions) {
  return std::ranges::any_of(actions, [](const SupervisorAction& action) {
    return std::holds_alternative<PublishInfo>(action);
  });
}

CommandOrder order(int run, bool force_quit = false, const std::string& id = "a") {
  CommandOrder made;
  made.spec.id = id;
  made.spec.exec = "prog";
  made.desired_run = run;
  made.force_quit = force_quit;
  return made;
}

class SupervisorTest : public ::testing::Test {
 protected:
  SupervisorActions take(std::vector<CommandOrder> commands, time::Duration age = {}) {
    return supervisor_.take_orders({{}, "rover", "sheriff", std::move(commands)}, age, now_);
  }
  void start_a(CommandOrder wanted = order(1)) {
    ASSERT_THAT(words(take({std::move(wanted)})), ElementsAre("start a: prog"));
    supervisor_.started("a", 100, now_);
  }
  [[nodiscard]] CommandStatus status() const { return supervisor_.statuses().at(0); }

  Supervisor supervisor_{"rover", true};
  time::SteadyTime now_{1000s};
};

TEST_F(SupervisorTest, StartsAWantedCommandOnce) {
  start_a();
  EXPECT_EQ(status().pid, 100);
  EXPECT_EQ(status().actual_run, 1);
  EXPECT_THAT(words(take({order(1)})), IsEmpty());
}

TEST_F(SupervisorTest, ACommandThatIsListedTwiceIsStartedOnce) {
  EXPECT_THAT(words(take({order(1), order(2)})), ElementsAre("start a: prog"));
  EXPECT_EQ(status().actual_run, 1) << "the first one counts";
}

TEST_F(SupervisorTest, DoesNothingAboutACommandThatWasNeverStarted) {
  const SupervisorActions actions = take({order(0)});
  EXPECT_THAT(words(actions), IsEmpty());
  EXPECT_TRUE(tells(actions)) << "the command is reported as known";
  EXPECT_THAT(words(take({order(1, true)})), IsEmpty());
  EXPECT_EQ(status().actual_run, 1) << "as in the existing deputy";
}

TEST_F(SupervisorTest, KillsAStoppedCommandAfterItsGraceTime) {
  CommandOrder wanted = order(1);
  wanted.spec.stop_signal = SIGTERM;
  wanted.spec.stop_time_allowed_s = 3.0;
  start_a(wanted);
  wanted.force_quit = true;
  EXPECT_THAT(words(take({wanted})), ElementsAre("signal a 15"));
  EXPECT_THAT(words(take({wanted})), IsEmpty()) << "signalled once only";
  EXPECT_EQ(supervisor_.next_due(), now_ + 3s);
  EXPECT_THAT(words(supervisor_.poll(now_ + 3s - 1us)), IsEmpty());
  EXPECT_THAT(words(supervisor_.poll(now_ + 3s)), ElementsAre("signal a 9"));
  EXPECT_THAT(words(supervisor_.poll(now_ + 3s + Supervisor::kKillPeriod)),
              ElementsAre("signal a 9"))
      << "again, as long as it runs";
  EXPECT_THAT(words(supervisor_.ended("a", SIGKILL, now_)), ElementsAre("say a: Killed\n"));
  EXPECT_EQ(status().wait_status, SIGKILL);
  EXPECT_EQ(status().pid, 0);
  EXPECT_FALSE(supervisor_.next_due().has_value());
}

TEST_F(SupervisorTest, ARestartStopsTheCommandAndALaterOrderStartsIt) {
  CommandOrder wanted = order(1);
  wanted.spec.auto_respawn = true;
  start_a(wanted);
  wanted.desired_run = 2;
  EXPECT_THAT(words(take({wanted})), ElementsAre("signal a 2"));
  EXPECT_THAT(words(supervisor_.ended("a", SIGINT, now_)), ElementsAre("say a: Interrupt\n"));
  EXPECT_EQ(status().actual_run, 1);
  EXPECT_THAT(words(supervisor_.poll(now_ + 10s)), IsEmpty()) << "no respawn of run 1";
  EXPECT_THAT(words(take({wanted})), ElementsAre("start a: prog"));
  EXPECT_EQ(status().actual_run, 2);
}

TEST_F(SupervisorTest, ACommandThatHasEndedByItselfIsNotStartedAgain) {
  start_a();
  EXPECT_THAT(words(supervisor_.ended("a", kExit3, now_)), IsEmpty());
  EXPECT_EQ(status().wait_status, 768);
  EXPECT_THAT(words(take({order(1)})), IsEmpty()) << "this run is over";
}

TEST_F(SupervisorTest, RespawnsWithDelaysThatDouble) {
  CommandOrder wanted = order(1);
  wanted.spec.auto_respawn = true;
  start_a(wanted);
  std::vector<std::int64_t> delays_ms;
  for (int i = 0; i < 10; ++i) {
    static_cast<void>(supervisor_.ended("a", kExit3, now_));
    const time::SteadyTime due = supervisor_.next_due().value();
    delays_ms.push_back((due - now_) / 1ms);
    EXPECT_THAT(words(supervisor_.poll(due - 1us)), IsEmpty());
    now_ = due;
    EXPECT_THAT(words(supervisor_.poll(now_)), ElementsAre("start a: prog"));
    supervisor_.started("a", 101 + i, now_);
  }
  EXPECT_THAT(delays_ms, ElementsAre(10, 20, 40, 80, 160, 320, 640, 1000, 1000, 1000));
  EXPECT_EQ(status().actual_run, 1);
  now_ += 3s;  // after three seconds the delay is halved three times
  static_cast<void>(supervisor_.ended("a", kExit3, now_));
  EXPECT_EQ(supervisor_.next_due().value() - now_, 125ms);
}

TEST_F(SupervisorTest, ReportsTheAgeOfARunAndTheNumberOfRestarts) {
  EXPECT_THAT(supervisor_.runs(now_), IsEmpty());
  CommandOrder wanted = order(1);
  wanted.spec.auto_respawn = true;
  start_a(wanted);
  EXPECT_THAT(supervisor_.runs(now_ + 5s), ElementsAre(CommandRun{"a", 100, 5s, 0}));
  static_cast<void>(supervisor_.ended("a", kExit3, now_ + 6s));
  EXPECT_THAT(supervisor_.runs(now_ + 6s), IsEmpty());
  static_cast<void>(supervisor_.poll(now_ + 7s));
  supervisor_.started("a", 101, now_ + 7s);
  EXPECT_THAT(supervisor_.runs(now_ + 9s), ElementsAre(CommandRun{"a", 101, 2s, 1}));
}

TEST_F(SupervisorTest, AStoppedCommandDoesNotRespawn) {
  CommandOrder wanted = order(1);
  wanted.spec.auto_respawn = true;
  start_a(wanted);
  static_cast<void>(supervisor_.ended("a", kExit3, now_));
  wanted.force_quit = true;
  static_cast<void>(take({wanted}));
  EXPECT_FALSE(supervisor_.next_due().has_value());
}

// A sheriff that has just begun orders what it has found.
TEST_F(SupervisorTest, AnOrderForTheSameRunLeavesTheRespawnDue) {
  CommandOrder wanted = order(1);
  wanted.spec.auto_respawn = true;
  start_a(wanted);
  static_cast<void>(supervisor_.ended("a", kExit3, now_));
  const auto due = supervisor_.next_due();
  EXPECT_THAT(words(take({wanted})), IsEmpty());
  EXPECT_EQ(supervisor_.next_due(), due);
  EXPECT_TRUE(due.has_value());
}

TEST_F(SupervisorTest, StopsAndForgetsACommandThatIsNotInTheOrders) {
  start_a();
  EXPECT_THAT(words(take({})), ElementsAre("signal a 2"));
  EXPECT_THAT(words(supervisor_.ended("a", 0, now_)), ElementsAre("forget a"));
  EXPECT_THAT(supervisor_.statuses(), IsEmpty());
  static_cast<void>(take({order(0)}));
  EXPECT_THAT(words(take({})), ElementsAre("forget a")) << "at once if it does not run";
}

TEST_F(SupervisorTest, AChangedExecTakesEffectAtTheNextStart) {
  start_a();
  CommandOrder changed = order(1);
  changed.spec.exec = "other";
  const SupervisorActions actions = take({changed});
  EXPECT_THAT(words(actions), IsEmpty());
  EXPECT_TRUE(tells(actions));
  EXPECT_EQ(status().spec.exec, "other");
  static_cast<void>(supervisor_.ended("a", 0, now_));
  changed.desired_run = 2;
  EXPECT_THAT(words(take({changed})), ElementsAre("start a: other"));
}

TEST_F(SupervisorTest, IgnoresOldOrdersAndThoseForOtherDeputies) {
  EXPECT_THAT(words(supervisor_.take_orders({{}, "other", "s", {order(1)}}, 0s, now_)), IsEmpty());
  const SupervisorActions actions = take({order(1)}, Supervisor::kMaxOrdersAge + 1us);
  EXPECT_THAT(words(actions),
              ElementsAre("say a: ignoring stale orders (utime 60 seconds ago). You may want to "
                          "check the system clocks!\n"));
  EXPECT_THAT(supervisor_.statuses(), IsEmpty());
  EXPECT_THAT(words(take({order(1)}, Supervisor::kMaxOrdersAge)), ElementsAre("start a: prog"));
}

TEST_F(SupervisorTest, InvalidSignalsAndGraceTimesAreReplaced) {
  CommandOrder wild = order(1);
  wild.spec.stop_signal = -5;
  wild.spec.stop_time_allowed_s = std::numeric_limits<double>::quiet_NaN();
  start_a(wild);
  wild.force_quit = true;
  EXPECT_THAT(words(take({wild})), ElementsAre("signal a 2"));
  EXPECT_EQ(supervisor_.next_due(), now_) << "an invalid grace time counts as none";
}

// Another sender gives orders without the running command, with a signal that freezes it, and with
// a grace time of a day: the process continues to run, and ends within a minute when it is stopped
// by name.
TEST_F(SupervisorTest, UntrustedOrdersDoNotStopACommandThatTheyOmit) {
  supervisor_ = Supervisor("rover", false);
  start_a();
  EXPECT_THAT(words(take({})), IsEmpty());
  EXPECT_THAT(words(take({order(1, false, "b")})), ElementsAre("start b: prog"));
  EXPECT_EQ(status().pid, 100);
  CommandOrder freeze = order(1, true);
  freeze.spec.stop_signal = SIGSTOP;
  freeze.spec.stop_time_allowed_s = 86'400.0;
  EXPECT_THAT(words(take({freeze})), ElementsAre("signal a " + std::to_string(SIGINT)));
  now_ += 60s;
  EXPECT_THAT(words(supervisor_.poll(now_)), ElementsAre("signal a " + std::to_string(SIGKILL)));
}

TEST_F(SupervisorTest, OrdersWithTooManyCommandsAreIgnored) {
  std::vector<CommandOrder> many;
  for (std::size_t i = 0; i <= Supervisor::kMaxCommands; ++i) {
    many.push_back(order(1, false, std::to_string(i)));
  }
  EXPECT_THAT(words(take(many)), IsEmpty());
  many.pop_back();
  EXPECT_EQ(words(take(many)).size(), Supervisor::kMaxCommands);
}

// The bytes of PM_INFO.
std::size_t info_bytes(const Supervisor& supervisor) {
  DeputyInfo info;
  info.commands = supervisor.statuses();
  std::vector<std::byte> bytes;
  bus::encode_into(bytes, to_message(info));
  return bytes.size();
}

std::size_t num_refused(const SupervisorActions& actions) {
  return static_cast<std::size_t>(std::ranges::count_if(
      actions, [](const auto& action) { return std::holds_alternative<RefuseOrder>(action); }));
}

// Each message names other commands; some have long names. Receivers refuse PM_INFO of more than
// 256 KiB, so that the sheriff would receive nothing from this deputy any more.
TEST_F(SupervisorTest, TheNumberOfCommandsIsLimitedInAllOrdersTogether) {
  for (const std::size_t length : {4U, 200U}) {
    supervisor_ = Supervisor("rover", false);
    start_a();
    std::size_t num_refusals = 0;
    for (int message = 0; message < 5; ++message) {
      std::vector<CommandOrder> many;
      for (int i = 0; i < 1000; ++i) {
        many.push_back(
            order(0, true, std::to_string(message * 1000 + i) + std::string(length, 'x')));
      }
      num_refusals += num_refused(take(std::move(many)));
    }
    EXPECT_EQ(supervisor_.statuses().size() + num_refusals, 5001U);
    EXPECT_LE(supervisor_.statuses().size(), Supervisor::kMaxCommands);
    EXPECT_LE(info_bytes(supervisor_), Supervisor::kMaxInfoBytes);
    CommandOrder longer = order(1, true);
    longer.spec.exec = std::string(200'000, 'x');
    EXPECT_THAT(words(take({longer})), ElementsAre("signal a 2")) << "it can still be stopped";
    EXPECT_LE(info_bytes(supervisor_), Supervisor::kMaxInfoBytes);
  }
}

TEST_F(SupervisorTest, ForgottenCommandsMakeRoomForOthers) {
  for (int message = 0; message < 3; ++message) {
    std::vector<CommandOrder> many;
    for (int i = 0; i < 1000; ++i) {
      many.push_back(order(0, true, std::to_string(message * 1000 + i)));
    }
    EXPECT_EQ(num_refused(take(many)), message == 0 ? 0U : 1000U);
    EXPECT_EQ(num_refused(take(many)), 0U) << "the omitted ones were forgotten";
  }
}

TEST_F(SupervisorTest, ACommandThatCannotBeStartedHasEndedWithExitCode127) {
  ASSERT_THAT(words(take({order(1)})), ElementsAre("start a: prog"));
  EXPECT_THAT(words(supervisor_.not_started("a", "no such file", now_)),
              ElementsAre("say a: no such file\n"));
  EXPECT_EQ(status().wait_status, 127 << 8);
  EXPECT_EQ(status().actual_run, 1);
  EXPECT_THAT(words(take({order(1)})), IsEmpty());
}

// It would be refused once a second, for ever.
TEST_F(SupervisorTest, ARefusedCommandIsStartedAgainOnlyWhenOtherExecLinesArePermitted) {
  CommandOrder wanted = order(1);
  wanted.spec.auto_respawn = true;
  ASSERT_THAT(words(take({wanted})), ElementsAre("start a: prog"));
  EXPECT_THAT(words(supervisor_.refused("a", "no", now_)), ElementsAre("say a: no\n"));
  EXPECT_EQ(status().wait_status, 127 << 8);
  EXPECT_FALSE(supervisor_.next_due().has_value());
  EXPECT_THAT(words(take({wanted})), IsEmpty());
  supervisor_.retry_refused(now_);
  EXPECT_THAT(words(supervisor_.poll(now_)), ElementsAre("start a: prog"));
  EXPECT_THAT(words(supervisor_.not_started("a", "no program", now_)),
              ElementsAre("say a: no program\n"));
  EXPECT_TRUE(supervisor_.next_due().has_value()) << "now it respawns as any other";
}

TEST_F(SupervisorTest, ARefusedCommandThatWasStoppedIsNotStartedAgain) {
  CommandOrder wanted = order(1);
  wanted.spec.auto_respawn = true;
  ASSERT_THAT(words(take({wanted})), ElementsAre("start a: prog"));
  static_cast<void>(supervisor_.refused("a", "no", now_));
  wanted.force_quit = true;
  static_cast<void>(take({wanted}));
  supervisor_.retry_refused(now_);
  EXPECT_THAT(words(supervisor_.poll(now_)), IsEmpty());
}

TEST_F(SupervisorTest, AtShutDownCommandsHaveTheirGraceTimeAndOrdersAreIgnored) {
  start_a();
  EXPECT_THAT(words(supervisor_.shut_down(now_)), ElementsAre("signal a 2"));
  EXPECT_THAT(words(take({order(2)})), IsEmpty());
  EXPECT_FALSE(supervisor_.is_idle());
  EXPECT_THAT(words(supervisor_.poll(now_ + 7s)), ElementsAre("signal a 9"));
  static_cast<void>(supervisor_.ended("a", SIGKILL, now_));
  EXPECT_TRUE(supervisor_.is_idle());
}

TEST_F(SupervisorTest, ASecondShutDownKillsCommandsAtOnce) {
  start_a();
  static_cast<void>(supervisor_.shut_down(now_));
  static_cast<void>(supervisor_.shut_down(now_));
  EXPECT_THAT(words(supervisor_.poll(now_)), ElementsAre("signal a 9"));
}

}  // namespace supervisor_test
}  // namespace nodmap::procman
