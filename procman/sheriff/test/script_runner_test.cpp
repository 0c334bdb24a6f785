// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/script_runner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <set>

#include "procman/config/parser.hpp"

namespace nodmap::procman {
namespace script_runner_test {

// A fleet on one host, whose deputy carries out orders at once.
class ScriptRunnerTest : public ::testing::Test {
 protected:
  Config config_ = parse_config(R"(
      group "g" { cmd "a" { exec = "x"; host = "h"; } cmd "b" { exec = "x"; host = "h"; } }
      cmd "c" { exec = "x"; host = "h"; }
      cmd "d" { exec = "x"; host = "h"; auto_respawn = "true"; }
      script "up" { start group "g" wait "running"; }
      script "respawned" { start cmd "d"; }
      script "healthy" { start cmd "d";
        #nodmap: wait cmd "d" status "healthy";
      }
      script "inner" { start cmd "c"; wait ms 100; }
      script "all" {
        start group "g" wait "running";
        run_script "inner";
        restart cmd "a" wait "running";
        stop group "g";
        wait group "g" status "stopped";
        stop everything wait "stopped";
      })")
                       .config;
  ScriptRunnerTest() { fleet_.take_command(now_); }

  Fleet fleet_{config_, "me:1:1"};
  time::SteadyTime now_{1s};
  std::map<std::string, CommandStatus> host_;
  std::set<std::string> healthy_;
  ScriptRunner::HealthTest is_healthy_ = [this](const std::string& id) {
    return healthy_.contains(id);
  };

  // Carries out the orders for these commands.
  void obey(const std::vector<std::string>& ids) {
    const Orders orders = fleet_.orders_for("h", {}).value();
    for (const CommandOrder& order : orders.commands) {
      CommandStatus& status = host_[order.spec.id];
      status.spec = order.spec;
      if (std::ranges::find(ids, order.spec.id) != ids.end()) {
        const bool stops = order.force_quit || order.desired_run != status.actual_run;
        if (status.pid != 0 && stops) {
          status.pid = 0;
        } else if (!order.force_quit && order.desired_run != status.actual_run) {
          status.pid = 100 + order.desired_run;
          status.wait_status = 0;
          status.actual_run = order.desired_run;
        }
      }
    }
    tell();
  }
  void end(const std::string& id, int wait_status) {
    host_[id].pid = 0;
    host_[id].wait_status = wait_status;
    tell();
  }
  void tell() {
    DeputyInfo info;
    info.deputy_id = "h";
    for (const auto& [id, status] : host_) {
      info.commands.push_back(status);
    }
    fleet_.take_info(info, now_);
  }
};

TEST_F(ScriptRunnerTest, ContinuesWhenAConditionThatItWaitsForIsMet) {
  ScriptRunner runner(config_, *config_.find_script("all"), is_healthy_);
  tell();
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "group \"g\" to be running");
  obey({"a"});
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "group \"g\" to be running") << "not all of the group runs";
  obey({"b"});
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "a moment") << "in the inner script";
  obey({"c"});
  EXPECT_TRUE(fleet_.is_running("c", now_));
  now_ += 100ms - 1us;
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "a moment");
  now_ += 1us;
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "cmd \"a\" to be running");
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "cmd \"a\" to be running") << "the former run does not count";
  obey({"a"});
  obey({"a"});
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "group \"g\" to be stopped");
  obey({"a", "b"});
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "everything to be stopped");
  EXPECT_FALSE(runner.is_over());
  obey({"c"});
  runner.step(fleet_, now_);
  EXPECT_TRUE(runner.is_over());
}

TEST_F(ScriptRunnerTest, AnEmptyScriptIsOverAtOnce) {
  const Script empty;
  ScriptRunner runner(config_, empty, is_healthy_);
  runner.step(fleet_, now_);
  EXPECT_TRUE(runner.is_over());
  EXPECT_EQ(runner.failure(), "");
}

TEST_F(ScriptRunnerTest, IsOverWhenAllStartedCommandsKeepRunning) {
  ScriptRunner runner(config_, *config_.find_script("up"), is_healthy_);
  tell();
  runner.step(fleet_, now_);
  obey({"a", "b"});
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "the started commands to keep running");
  now_ += ScriptRunner::kLastingTime;
  runner.step(fleet_, now_);
  EXPECT_TRUE(runner.is_over());
  EXPECT_EQ(runner.failure(), "");
}

TEST_F(ScriptRunnerTest, FailsWhenAStartedCommandEndsWithAnError) {
  ScriptRunner runner(config_, *config_.find_script("up"), is_healthy_);
  tell();
  runner.step(fleet_, now_);
  obey({"a", "b"});
  runner.step(fleet_, now_);
  end("b", 2 << 8);
  now_ += ScriptRunner::kLastingTime;
  runner.step(fleet_, now_);
  EXPECT_TRUE(runner.is_over());
  EXPECT_EQ(runner.failure(), "b has ended (exit 2)");
}

TEST_F(ScriptRunnerTest, FailsAtOnceWhenACommandThatItWaitsForHasEnded) {
  ScriptRunner runner(config_, *config_.find_script("up"), is_healthy_);
  tell();
  runner.step(fleet_, now_);
  obey({"a", "b"});
  end("a", SIGSEGV);
  runner.step(fleet_, now_);
  EXPECT_TRUE(runner.is_over());
  EXPECT_EQ(runner.failure(), "a has ended (killed by signal 11 (Segmentation fault))");
}

// The deputy respawns the command again and again.
TEST_F(ScriptRunnerTest, FailsWhenARespawningCommandDoesNotKeepRunning) {
  ScriptRunner runner(config_, *config_.find_script("respawned"), is_healthy_);
  tell();
  runner.step(fleet_, now_);
  obey({"d"});
  const time::SteadyTime stop = now_ + ScriptRunner::kSettleTimeout;
  for (; now_ <= stop; now_ += 300ms) {
    end("d", 2 << 8);
    runner.step(fleet_, now_);
    host_["d"].pid = 500;
    tell();
    runner.step(fleet_, now_);
  }
  runner.step(fleet_, now_);
  EXPECT_TRUE(runner.is_over());
  EXPECT_EQ(runner.failure(), "d does not keep running (exit 2)");
}

// It follows another sheriff, for example.
TEST_F(ScriptRunnerTest, FailsWhenTheDeputyDoesNotObey) {
  ScriptRunner runner(config_, *config_.find_script("respawned"), is_healthy_);
  const time::SteadyTime stop = now_ + ScriptRunner::kSettleTimeout;
  for (; now_ < stop; now_ += 1s) {
    tell();
    runner.step(fleet_, now_);
    EXPECT_FALSE(runner.is_over());
  }
  tell();
  runner.step(fleet_, now_);
  EXPECT_TRUE(runner.is_over());
  EXPECT_EQ(runner.failure(), "d has not been started");
}

TEST_F(ScriptRunnerTest, ACommandThatEndsWithoutAnErrorIsNotAFailure) {
  ScriptRunner runner(config_, *config_.find_script("inner"), is_healthy_);
  tell();
  runner.step(fleet_, now_);
  obey({"c"});
  end("c", 0);
  now_ += 100ms;
  runner.step(fleet_, now_);
  EXPECT_TRUE(runner.is_over());
  EXPECT_EQ(runner.failure(), "");
}

TEST_F(ScriptRunnerTest, WaitsUntilARunningCommandIsHealthy) {
  ScriptRunner runner(config_, *config_.find_script("healthy"), is_healthy_);
  healthy_ = {"d"};  // an old STATUS: it does not run yet
  tell();
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "cmd \"d\" to be healthy");
  healthy_.clear();
  obey({"d"});
  runner.step(fleet_, now_);
  EXPECT_EQ(runner.waiting_for(), "cmd \"d\" to be healthy");
  healthy_ = {"d"};
  runner.step(fleet_, now_);
  EXPECT_NE(runner.waiting_for(), "cmd \"d\" to be healthy");
}

}  // namespace script_runner_test
}  // namespace nodmap::procman
