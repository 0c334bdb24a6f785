// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/health_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "procman/config/parser.hpp"

namespace nodmap::procman {
namespace health_watch_test {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint32_t kHost = 0x7F000001;
constexpr bus::Sender kOwn{kHost, 40'000};
constexpr bus::Sender kOther{kHost, 40'001};
constexpr bus::Sender kOtherHost{0x7F000002, 40'000};

class HealthWatchTest : public ::testing::Test {
 protected:
  Config config_ = parse_config(R"(cmd "a" {
      exec = "X=1 /opt/bin/nodmap-a --flag"; host = "h";
      #nodmap: restart_silent_s = 5; restart_failed_s = 10;
    })")
                       .config;
  Fleet fleet_{config_, "me:1:1"};
  HealthWatch watch_{config_};
  time::SteadyTime now_{1000s};

  void report(int pid = 7) {
    DeputyInfo info;
    info.deputy_id = "h";
    CommandStatus status;
    status.spec.id = "a";
    status.pid = pid;
    status.actual_run = 1;
    info.commands = {status};
    fleet_.take_info(info, now_, {kHost, 1});
  }
  void speak(ProcessHealth::State state, const bus::Sender& sender = kOwn) {
    ProcessHealth health;
    health.state = state;
    health.reason = "no scans";
    watch_.take_status("nodmap-a", health, fleet_, now_, sender);
  }
  // Seconds until the restart, at most `limit`; 0 if there is none.
  template <class Each>
  int seconds_to_restart(int limit, Each each) {
    for (int second = 1; second <= limit; ++second) {
      now_ += 1s;
      each();
      report();
      const auto restarts = watch_.due_restarts(fleet_, now_);
      if (!restarts.empty()) {
        reason_ = restarts[0].reason;
        return second;
      }
    }
    return 0;
  }
  std::string reason_;
};

TEST_F(HealthWatchTest, AStatusBelongsToTheCommandWithItsProgram) {
  EXPECT_EQ(status_name(config_.commands[0]), "nodmap-a");
  Command named = config_.commands[0];
  named.health.status_name = "other";
  EXPECT_EQ(status_name(named), "other");
  Command empty;
  empty.exec = "A=1 ";
  EXPECT_EQ(status_name(empty), "");
  EXPECT_FALSE(watch_.last_status_of("a").has_value());
  speak(ProcessHealth::State::kDegraded);
  EXPECT_EQ(watch_.last_status_of("a")->health.state, ProcessHealth::State::kDegraded);
  EXPECT_EQ(watch_.last_status_of("a")->received, now_);
}

TEST_F(HealthWatchTest, RestartsADegradedCommandIfItHasARuleForThat) {
  report();
  const auto degraded = [this] { speak(ProcessHealth::State::kDegraded); };
  EXPECT_EQ(seconds_to_restart(60, degraded), 0) << "no rule";
  config_.commands[0].health.restart_degraded_s = 20;
  EXPECT_EQ(seconds_to_restart(1, degraded), 1) << "it has been degraded for a minute";
  EXPECT_THAT(reason_, HasSubstr("DEGRADED for"));
  EXPECT_THAT(reason_, HasSubstr("no scans"));
  speak(ProcessHealth::State::kOk);
  EXPECT_EQ(seconds_to_restart(41, degraded), 0) << "twice as long after a restart";
}

TEST_F(HealthWatchTest, RestartsACommandThatStopsSendingStatus) {
  report();
  EXPECT_EQ(seconds_to_restart(60, [this] { speak(ProcessHealth::State::kOk); }), 0);
  EXPECT_EQ(seconds_to_restart(60, [] {}), 6) << "more than five";
  EXPECT_THAT(reason_, HasSubstr("no STATUS for 6 s"));
}

TEST_F(HealthWatchTest, RestartsACommandThatNeverSendsStatus) {
  report();
  EXPECT_EQ(seconds_to_restart(60, [] {}), 6);
}

TEST(HealthWatchMute, RestartsACommandThatWritesNoOutput) {
  const Config config = parse_config(R"(cmd "a" { exec = "x"; host = "h";
      #nodmap: restart_mute_s = 5;
    })")
                            .config;
  Fleet fleet(config, "me:1:1");
  HealthWatch watch(config);
  const auto at = [](int second) { return time::SteadyTime(second * 1s); };
  const auto restarts_at = [&](int second) {
    DeputyInfo info;
    info.deputy_id = "h";
    info.commands.resize(1);
    info.commands[0].spec.id = "a";
    info.commands[0].pid = 7;
    info.commands[0].actual_run = 1;
    fleet.take_info(info, at(second));
    return watch.due_restarts(fleet, at(second));
  };
  for (int second = 1; second <= 20; ++second) {
    watch.take_output("a", at(second));
    EXPECT_THAT(restarts_at(second), IsEmpty());
  }
  for (int second = 21; second <= 25; ++second) {
    watch.take_output("b", at(second));  // of another command, and of an unknown one
    EXPECT_THAT(restarts_at(second), IsEmpty());
  }
  const auto restarts = restarts_at(26);
  ASSERT_EQ(restarts.size(), 1U);
  EXPECT_EQ(restarts[0].reason, "no output for 6 s");
}

TEST_F(HealthWatchTest, RestartsACommandThatHasFailedForLong) {
  report();
  EXPECT_EQ(seconds_to_restart(60, [this] { speak(ProcessHealth::State::kFailed); }), 12)
      << "more than ten after the first FAILED";
  EXPECT_THAT(reason_, HasSubstr("FAILED for 11 s: no scans"));
}

TEST_F(HealthWatchTest, AShortFailureCausesNoRestart) {
  report();
  int second = 0;
  EXPECT_EQ(seconds_to_restart(60,
                               [&] {
                                 speak(++second % 10 == 0 ? ProcessHealth::State::kOk
                                                          : ProcessHealth::State::kFailed);
                               }),
            0);
}

TEST_F(HealthWatchTest, WaitsLongerBeforeEachRestartUpToALimit) {
  report();
  std::vector<int> seconds;
  for (int i = 0; i < 8; ++i) {
    seconds.push_back(seconds_to_restart(1000, [] {}));
  }
  EXPECT_THAT(seconds, ::testing::ElementsAre(6, 11, 21, 41, 81, 161, 161, 161));
  EXPECT_EQ(seconds_to_restart(62, [this] { speak(ProcessHealth::State::kOk); }), 0);
  EXPECT_EQ(seconds_to_restart(60, [] {}), 6) << "as short as at first after a minute in health";
}

// The link to the host failed, not the process.
TEST_F(HealthWatchTest, ABrokenLinkCausesNoRestart) {
  report();
  EXPECT_EQ(seconds_to_restart(10, [this] { speak(ProcessHealth::State::kOk); }), 0);
  for (int second = 0; second < 10; ++second) {
    now_ += 1s;
    EXPECT_THAT(watch_.due_restarts(fleet_, now_), IsEmpty());
  }
  report();
  EXPECT_THAT(watch_.due_restarts(fleet_, now_), IsEmpty()) << "INFO came before STATUS";
  EXPECT_EQ(seconds_to_restart(10, [this] { speak(ProcessHealth::State::kOk); }), 0);
}

// They say that all is well, on the same host and on another one, more often than the process.
TEST_F(HealthWatchTest, AStatusOfAnotherProcessHidesNoFailure) {
  report();
  speak(ProcessHealth::State::kFailed);
  const auto forge = [this] {
    speak(ProcessHealth::State::kOk, kOther);
    speak(ProcessHealth::State::kOk, kOtherHost);
  };
  EXPECT_EQ(seconds_to_restart(60,
                               [&] {
                                 forge();
                                 speak(ProcessHealth::State::kFailed);
                                 forge();
                               }),
            11);
}

TEST_F(HealthWatchTest, AForgedFailureRestartsNothingAndIsReported) {
  report();
  speak(ProcessHealth::State::kOk);
  EXPECT_THAT(watch_.contested_names(now_), IsEmpty());
  EXPECT_EQ(seconds_to_restart(60,
                               [this] {
                                 speak(ProcessHealth::State::kFailed, kOther);
                                 speak(ProcessHealth::State::kOk);
                               }),
            0);
  EXPECT_EQ(watch_.last_status_of("a")->health.state, ProcessHealth::State::kOk);
  EXPECT_THAT(watch_.contested_names(now_), ::testing::ElementsAre("nodmap-a"));
  EXPECT_THAT(watch_.contested_names(now_ + 10s), IsEmpty()) << "when it is over";
}

TEST_F(HealthWatchTest, AProcessThatWasStartedAgainIsBelievedAtOnce) {
  report();
  speak(ProcessHealth::State::kFailed);
  now_ += 100ms;
  report(8);
  now_ += 1s;
  speak(ProcessHealth::State::kOk, kOther);
  EXPECT_EQ(watch_.last_status_of("a")->health.state, ProcessHealth::State::kOk);
  EXPECT_THAT(watch_.contested_names(now_), IsEmpty());
}

// A script that starts its program again has the same process number.
TEST_F(HealthWatchTest, AnotherSocketIsBelievedWhenTheFirstIsSilent) {
  report();
  speak(ProcessHealth::State::kFailed);
  now_ += node::kStatusSilence - 1us;
  report();
  speak(ProcessHealth::State::kOk, kOther);
  EXPECT_EQ(watch_.last_status_of("a")->health.state, ProcessHealth::State::kFailed);
  now_ += 1us;
  speak(ProcessHealth::State::kOk, kOther);
  EXPECT_EQ(watch_.last_status_of("a")->health.state, ProcessHealth::State::kOk);
}

// Two commands of one host, of which one does not run, and one on another host.
TEST(HealthWatchProgram, CommandsOfTheSameProgramHaveTheirOwnStatus) {
  const Config config = parse_config(R"(
    cmd "idle" { exec = "log --b"; host = "h"; } cmd "a" { exec = "log"; host = "h"; }
    cmd "b" { exec = "log"; host = "h"; } cmd "far" { exec = "log"; host = "other"; })")
                            .config;
  Fleet fleet(config, "me:1:1");
  HealthWatch watch(config);
  const time::SteadyTime now(100s);
  const auto tell = [&](const std::string& deputy, std::uint32_t address,
                        const std::vector<std::pair<std::string, int>>& pids) {
    DeputyInfo info;
    info.deputy_id = deputy;
    for (const auto& [id, pid] : pids) {
      info.commands.emplace_back();
      info.commands.back().spec.id = id;
      info.commands.back().pid = pid;
    }
    fleet.take_info(info, now, {address, 1});
  };
  tell("h", kHost, {{"idle", 0}, {"a", 7}, {"b", 8}});
  tell("other", kOtherHost.address, {{"far", 9}});
  for (int i = 0; i < 3; ++i) {
    for (const bus::Sender& sender : {kOtherHost, kOther, kOwn}) {
      ProcessHealth health;
      health.lost = sender.port + (sender == kOtherHost ? 1000 : 0);
      watch.take_status("log", health, fleet, now, sender);
    }
  }
  EXPECT_FALSE(watch.last_status_of("idle"));
  EXPECT_EQ(watch.last_status_of("a")->health.lost, kOther.port);
  EXPECT_EQ(watch.last_status_of("b")->health.lost, kOwn.port);
  EXPECT_EQ(watch.last_status_of("far")->health.lost, kOtherHost.port + 1000);
  EXPECT_THAT(watch.contested_names(now), IsEmpty());
}

TEST_F(HealthWatchTest, DoesNotRestartACommandThatDoesNotRun) {
  report(0);
  now_ += 100s;
  report(0);
  EXPECT_THAT(watch_.due_restarts(fleet_, now_), IsEmpty());
}

// Our processes are DEGRADED while anybody sends what they refuse, and where the configuration
// makes them: a laser that is held level, a servo that does not measure. A restart would change
// nothing, and cost the obstacle map.
class ShippedRules : public ::testing::TestWithParam<const char*> {};

TEST_P(ShippedRules, AnHourOfRefusedMessagesRestartsNothing) {
  const Config config = load_config(std::string(NODMAP_PMD_DIR) + "/" + GetParam());
  Fleet fleet(config, "me:1:1");
  HealthWatch watch(config);
  std::map<std::string, DeputyInfo> deputies;
  for (const Command& command : config.commands) {
    CommandStatus status;
    status.spec.id = command.id;
    status.pid = 7;
    status.actual_run = 1;
    DeputyInfo& deputy = deputies[command.deputy];
    deputy.deputy_id = command.deputy;
    deputy.commands.push_back(status);
  }
  const ProcessHealth refusing{.state = ProcessHealth::State::kDegraded,
                               .reason = "messages of 10.9.9.9 are refused"};
  for (time::SteadyTime now{1000s}; now < time::SteadyTime{4600s}; now += 1s) {
    for (const auto& [name, info] : deputies) {
      fleet.take_info(info, now, {kHost, 1});
    }
    std::uint16_t port = 40'000;
    for (const Command& command : config.commands) {
      watch.take_status(status_name(command), refusing, fleet, now, {kHost, port++});
    }
    const auto restarts = watch.due_restarts(fleet, now);
    ASSERT_THAT(restarts, IsEmpty()) << restarts[0].command_id << ": " << restarts[0].reason;
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedRules,
                         ::testing::Values("robot.pmd", "sim.pmd", "replay.pmd", "two_hosts.pmd"));

}  // namespace health_watch_test
}  // namespace nodmap::procman
