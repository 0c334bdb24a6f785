// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/script_runner.hpp"

#include <gtest/gtest.h>

#include "procman/config/parser.hpp"

namespace nodmap::procman {
namespace {

constexpr std::int64_t kMs = 1'000;

/// A fleet on one host whose deputy does at once what it is told.
class ScriptRunnerTest : public ::testing::Test {
 protected:
  Config config_ = parse_config(R"(
      group "g" { cmd "a" { exec = "x"; host = "h"; } cmd "b" { exec = "x"; host = "h"; } }
      cmd "c" { exec = "x"; host = "h"; }
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
  Fleet fleet_{config_, "me:1:1"};
  std::int64_t now_us_ = 1'000'000;
  std::map<std::string, CommandStatus> host_;

  /// Carries the orders out, for the commands that are named.
  void obey(const std::vector<std::string>& ids) {
    const Orders orders = fleet_.orders_for("h", 0).value();
    for (const CommandOrder& order : orders.commands) {
      CommandStatus& status = host_[order.spec.id];
      status.spec = order.spec;
      if (std::find(ids.begin(), ids.end(), order.spec.id) != ids.end()) {
        const bool stops = order.force_quit || order.desired_run != status.actual_run;
        if (status.pid != 0 && stops) {
          status.pid = 0;
        } else if (!order.force_quit && order.desired_run != status.actual_run) {
          status.pid = 100 + order.desired_run;
          status.actual_run = order.desired_run;
        }
      }
    }
    tell();
  }
  void tell() {
    DeputyInfo info;
    info.deputy_id = "h";
    for (const auto& [id, status] : host_) {
      info.commands.push_back(status);
    }
    fleet_.take_info(info, now_us_);
  }
};

TEST_F(ScriptRunnerTest, GoesOnWhenWhatItWaitsForIsSo) {
  ScriptRunner runner(config_, *config_.find_script("all"));
  tell();
  runner.step(fleet_, now_us_);
  EXPECT_EQ(runner.waiting_for(), "group \"g\" to be running");
  obey({"a"});
  runner.step(fleet_, now_us_);
  EXPECT_EQ(runner.waiting_for(), "group \"g\" to be running") << "not all of it runs";
  obey({"b"});
  runner.step(fleet_, now_us_);
  EXPECT_EQ(runner.waiting_for(), "a moment") << "in the inner script";
  obey({"c"});
  EXPECT_TRUE(fleet_.has_reached("c", Wanted::kRunning, now_us_));
  now_us_ += 100 * kMs - 1;
  runner.step(fleet_, now_us_);
  EXPECT_EQ(runner.waiting_for(), "a moment");
  now_us_ += 1;
  runner.step(fleet_, now_us_);
  EXPECT_EQ(runner.waiting_for(), "cmd \"a\" to be running");
  runner.step(fleet_, now_us_);
  EXPECT_EQ(runner.waiting_for(), "cmd \"a\" to be running") << "the old run does not count";
  obey({"a"});
  obey({"a"});
  runner.step(fleet_, now_us_);
  EXPECT_EQ(runner.waiting_for(), "group \"g\" to be stopped");
  obey({"a", "b"});
  runner.step(fleet_, now_us_);
  EXPECT_EQ(runner.waiting_for(), "everything to be stopped");
  EXPECT_FALSE(runner.done());
  obey({"c"});
  runner.step(fleet_, now_us_);
  EXPECT_TRUE(runner.done());
}

TEST_F(ScriptRunnerTest, AnEmptyScriptIsDone) {
  const Script empty;
  EXPECT_TRUE(ScriptRunner(config_, empty).done());
}

}  // namespace
}  // namespace nodmap::procman
