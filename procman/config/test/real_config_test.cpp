// SPDX-License-Identifier: BSD-3-Clause
// The configurations of this folder.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>

#include "procman/config/exec_line.hpp"
#include "procman/config/parser.hpp"
#include "tests/support/program.hpp"

namespace nodmap::procman {
namespace real_config_test {

const std::string kFolder = std::string(NODMAP_PMD_DIR) + "/";

// A sheriff first looks for others, for up to 2.6 s.
constexpr int kSheriffBeginsWithinS = 3;

// The longest time that a script's stop orders may take: it waits for each before the next, and
// the commands of one order stop at the same time.
int time_to_stop_s(const Config& config, const std::string& script) {
  std::set<std::string> stopped;
  int total_s = 0;
  for (const Action& action : config.find_script(script)->actions) {
    int longest_s = 0;
    for (const Command* command : config.commands_of(std::get<Order>(action.what).target)) {
      const bool is_running = stopped.insert(command->id).second;
      longest_s = std::max(longest_s, is_running ? command->stop_time_allowed_s : 0);
    }
    total_s += longest_s;
  }
  return total_s;
}

// The number that follows a text in a file.
int number_after(const std::string& text, const std::string& file) {
  const std::string content = test::slurp(kFolder + file);
  const std::size_t at = content.find(text);
  return at == std::string::npos ? -1 : std::stoi(content.substr(at + text.size()));
}

class RealConfig : public ::testing::TestWithParam<const char*> {
 protected:
  Config config_ = load_config(kFolder + GetParam());
};

TEST_P(RealConfig, IsValidAndTruncatedAnywhereItIsReadWithoutACrash) {
  const std::string text = test::slurp(kFolder + GetParam());
  EXPECT_TRUE(parse_config(text).errors.empty());
  int num_errors = 0;
  for (std::size_t size = 0; size < text.size(); ++size) {
    const ParsedConfig cut = parse_config(std::string_view(text).substr(0, size));
    num_errors += cut.errors.empty() ? 0 : 1;
    for (const ConfigError& error : cut.errors) {
      EXPECT_GE(error.place.line, 1);
      EXPECT_GE(error.place.column, 1);
    }
  }
  EXPECT_GT(num_errors, 0);
}

// `host` is the name that the existing tools used before 2015; our configurations use the present
// one.
TEST_P(RealConfig, UsesTheWordDeputyAsTheExistingToolsDo) {
  std::istringstream text(test::slurp(kFolder + GetParam()));
  int num_deputies = 0;
  for (std::string line; std::getline(text, line);) {
    EXPECT_EQ(line.find("host = "), std::string::npos) << line;
    num_deputies += line.find("deputy = ") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(static_cast<std::size_t>(num_deputies), config_.commands.size());
}

// While somebody forges DRIVE it is FAILED; it would be restarted, and a person would have to
// release the robot.
TEST_P(RealConfig, TheBaseDriverIsRestartedOnlyWhenItIsSilent) {
  for (const Command& command : config_.commands) {
    if (program_of(command.exec) == "nodmap-kurt") {
      EXPECT_FALSE(command.health.restart_failed_s);
      EXPECT_FALSE(command.health.restart_degraded_s);
      EXPECT_TRUE(command.health.restart_silent_s);
    }
  }
}

// It connects again by itself. Each start may write twice to the laser's memory, which wears out.
TEST_P(RealConfig, TheLaserDriverIsRestartedOnlyWhenItIsSilent) {
  for (const Command& command : config_.commands) {
    if (program_of(command.exec) == "nodmap-laser3d") {
      EXPECT_FALSE(command.health.restart_failed_s);
      EXPECT_FALSE(command.health.restart_degraded_s);
      EXPECT_TRUE(command.health.restart_silent_s);
    }
  }
}

// systemd, and `./nodmap demo`, would give up while a command still saves its map.
TEST_P(RealConfig, WhoeverRunsStopAllWaitsLongerThanItsCommandsMayTake) {
  const int allowed_s = time_to_stop_s(config_, "stop_all");
  EXPECT_GT(allowed_s, 0);
  EXPECT_GE(number_after("--timeout ", "systemd/nodmap-robot.service"),
            allowed_s + kSheriffBeginsWithinS);
  EXPECT_GE(number_after("--script stop_all --on-script-complete exit --timeout ",
                         "../scripts/demo_sim.sh"),
            allowed_s + kSheriffBeginsWithinS);
  EXPECT_GT(number_after("TimeoutStopSec=", "systemd/nodmap-robot.service"),
            number_after("--timeout ", "systemd/nodmap-robot.service"));
}

TEST_P(RealConfig, SystemdWaitsLongerForADeputyThanAnyCommandMayTake) {
  for (const Command& command : config_.commands) {
    EXPECT_GT(number_after("TimeoutStopSec=", "systemd/nodmap-deputy.service"),
              command.stop_time_allowed_s)
        << command.id;
  }
}

// It is FAILED while the disk is full, and tries again by itself. Each start begins a new file.
TEST_P(RealConfig, TheLoggerIsNotRestartedWhenItHasFailed) {
  for (const Command& command : config_.commands) {
    if (program_of(command.exec) == "nodmap-logger") {
      EXPECT_FALSE(command.health.restart_failed_s);
      EXPECT_FALSE(command.health.restart_degraded_s);
    }
  }
}

// Its messages wait while the disk stalls, and so does its STATUS. They last for 12 s.
TEST_P(RealConfig, TheLoggerIsNotRestartedWhileTheDiskStalls) {
  constexpr int kMessagesLastS = 12;
  for (const Command& command : config_.commands) {
    if (program_of(command.exec) == "nodmap-logger") {
      EXPECT_GE(command.health.restart_silent_s.value_or(1000), 2 * kMessagesLastS);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, RealConfig,
                         ::testing::Values("robot.pmd", "sim.pmd", "replay.pmd", "two_hosts.pmd"));

}  // namespace real_config_test
}  // namespace nodmap::procman
