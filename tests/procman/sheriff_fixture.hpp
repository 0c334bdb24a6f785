// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "tests/procman/deputy_client.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap::test {

/// A deputy `rover`, and sheriffs with a configuration of four commands. A test fails if a process
/// of a command is left at its end.
class SheriffProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(file_) << R"(
      group "g" {
        cmd "sleeper" { exec = ")"
                         << marked("sleep 1000") << R"("; host = "rover"; auto_respawn = "true";
                        #nodmap: status_name = "sleeper"; restart_failed_s = 1;
                      }
        cmd "talker" { exec = ")"
                         << marked("bash -c 'while true; do echo word; sleep 0.1; done'")
                         << R"("; host = "rover"; }
      }
      cmd "wrong" { exec = ")"
                         << marked("bash -c 'exit 3'") << R"("; host = "rover"; }
      cmd "far" { exec = "x"; host = "absent"; }
      script "up" { start group "g" wait "running"; }
      script "down" { stop group "g" wait "stopped"; }
      script "never" { start cmd "far" wait "running"; }
      # Waits, because "wrong" may take longer to end than what counts as running on.
      script "dead" { start group "g" wait "running"; start cmd "wrong" wait "stopped"; }
    )";
  }
  void TearDown() override {
    sheriff_.reset();
    if (deputy_) {
      deputy_->send_signal(SIGTERM);
      EXPECT_EQ(deputy_->wait_for_end(kPatience), 0) << deputy_->said();
    }
    EXPECT_THAT(processes_marked(mark_), ::testing::IsEmpty());
  }

  [[nodiscard]] std::string marked(const std::string& exec) const {
    return "NODMAP_TEST=" + mark_ + " " + exec;
  }
  void begin_deputy() {
    deputy_ = std::make_unique<ChildProcess>(std::vector<std::string>{
        NODMAP_BIN "/nodmap-deputy", "--lcm-url", kProcmanUrl, file_, "--id", "rover"});
    ASSERT_TRUE(deputy_->wait_for_stderr("serving", kPatience)) << deputy_->said();
    ASSERT_TRUE(client_.wait_until([this] { return !client_.infos().empty(); }));
  }
  [[nodiscard]] ProgramResult sheriff(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {file_, "--lcm-url", kProcmanUrl});
    return run_program("nodmap-sheriff", arguments);
  }
  /// Begins a deputy whose command "talker" is this bash script, and starts it.
  void run_script_as_talker(const std::string& script) {
    std::ofstream(dir_.path() / "talker") << script << "\n";
    std::ofstream(file_) << R"(cmd "talker" { exec = ")"
                         << marked("bash " + (dir_.path() / "talker").string())
                         << R"("; host = "rover"; })";
    begin_deputy();
    ASSERT_EQ(sheriff({"--start", "talker"}).exit_code, 0);
  }
  /// Starts a sheriff that runs a script and stays; what it prints is in printed().
  void begin_sheriff(const std::string& script) {
    begin_task("--script " + script + " --on-script-complete stay");
  }
  /// The same for a sheriff with other options.
  void begin_task(const std::string& options) {
    sheriff_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{"sh", "-c",
                                 "exec " NODMAP_BIN "/nodmap-sheriff " + file_ + " --lcm-url '" +
                                     kProcmanUrl + "' " + options + " >" + printed_});
  }
  [[nodiscard]] std::string printed() const {
    std::ifstream in(printed_);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] bool has_printed(const std::string& text) const {
    return printed().find(text) != std::string::npos;
  }
  /// Starts both, and waits until the commands of the group run.
  void begin_both() {
    begin_deputy();
    begin_sheriff("up");
    ASSERT_TRUE(
        client_.wait_until([this] { return client_.runs("sleeper") && client_.runs("talker"); }));
  }

  std::string mark_ = std::to_string(::getpid()) + "-" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name();
  TemporaryDir dir_;
  std::string file_ = dir_.path() / "robot.pmd";
  std::string printed_ = dir_.path() / "printed";
  DeputyClient client_{"rover"};
  std::unique_ptr<ChildProcess> deputy_;
  std::unique_ptr<ChildProcess> sheriff_;
};

}  // namespace nodmap::test
