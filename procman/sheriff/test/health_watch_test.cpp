// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/health_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "procman/config/parser.hpp"

namespace nodmap::procman {
namespace health_watch_test {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

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
    fleet_.take_info(info, now_);
  }
  void speak(ProcessHealth::State state) {
    ProcessHealth health;
    health.state = state;
    health.reason = "no scans";
    watch_.take_status("nodmap-a", health, now_);
  }
  /// Seconds until the restart, at most `limit`; 0 if there is none.
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

TEST_F(HealthWatchTest, DoesNotRestartACommandThatDoesNotRun) {
  report(0);
  now_ += 100s;
  report(0);
  EXPECT_THAT(watch_.due_restarts(fleet_, now_), IsEmpty());
}

}  // namespace health_watch_test
}  // namespace nodmap::procman
