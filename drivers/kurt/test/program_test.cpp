// SPDX-License-Identifier: BSD-3-Clause
// nodmap-kurt as a process, with the emulated base on a pseudo-terminal. memq:// keeps it off the
// network; what comes over the bus is tested with the node.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "drivers/kurt/test/kurt_emulator.hpp"
#include "tests/support/pty_pair.hpp"

namespace nodmap::kurt {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// A process that is killed, at the latest, with this object.
class Process {
 public:
  explicit Process(std::vector<std::string> arguments) : pid_(::fork()) {
    if (pid_ == 0) {
      arguments.insert(arguments.begin(), NODMAP_KURT_PROGRAM);
      std::vector<char*> argv;
      for (std::string& argument : arguments) {
        argv.push_back(argument.data());
      }
      argv.push_back(nullptr);
      ::execv(argv[0], argv.data());
      ::_exit(99);
    }
  }
  ~Process() {
    if (!exit_code_) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  Process(Process&&) = delete;
  Process& operator=(Process&&) = delete;

  void signal(int number) const { ::kill(pid_, number); }

  /// Its exit code, or 128 + the signal that killed it; empty while it lives.
  std::optional<int> exit_code() {
    int status = 0;
    if (!exit_code_ && ::waitpid(pid_, &status, WNOHANG) == pid_) {
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return exit_code_;
  }

 private:
  pid_t pid_;
  std::optional<int> exit_code_;
};

/// Plays the base in real time until `done`; gives up after 20 s.
template <class Condition>
bool play(test::PtyPair& pty, test::KurtEmulator& base, Condition done) {
  const auto deadline = steady_clock::now() + std::chrono::seconds(20);
  auto next_tick = steady_clock::now();
  while (!done() && steady_clock::now() < deadline) {
    const std::string answer = base.take(pty.receive_text(1, milliseconds(10)));
    std::string frames;
    for (; next_tick <= steady_clock::now(); next_tick += milliseconds(10)) {
      frames += base.tick();
    }
    if (!(answer + frames).empty()) {
      pty.send(answer + frames);
    }
  }
  return done();
}

std::vector<std::string> arguments_for(const test::PtyPair& pty) {
  return {"--lcm-url", "memq://", "--set", "device=" + pty.name(), "--log-level", "off"};
}

TEST(KurtProgram, StartsStandsAndEndsWithAHardStop) {
  test::PtyPair pty;
  test::KurtEmulator base;
  Process process(arguments_for(pty));
  ASSERT_TRUE(play(pty, base, [&] { return base.commands() >= 20; }));
  EXPECT_FALSE(base.braked());
  EXPECT_EQ(base.left_cm_s(), 0);
  EXPECT_EQ(pty.baud(), 1'000'000);
  process.signal(SIGTERM);
  ASSERT_TRUE(play(pty, base, [&] { return process.exit_code().has_value() && base.braked(); }));
  EXPECT_EQ(*process.exit_code(), 0);
  EXPECT_EQ(base.nonsense(), 0);
}

TEST(KurtProgram, EndsWithThePlugPulledOut) {
  test::PtyPair pty;
  test::KurtEmulator base;
  Process process(arguments_for(pty));
  ASSERT_TRUE(play(pty, base, [&] { return base.commands() >= 20; }));
  pty.unplug();
  process.signal(SIGINT);
  test::PtyPair unused;
  ASSERT_TRUE(play(unused, base, [&] { return process.exit_code().has_value(); }));
  EXPECT_EQ(*process.exit_code(), 0);
}

TEST(KurtProgram, WrongConfigurationIsExitCodeTwo) {
  test::PtyPair pty;
  test::KurtEmulator base;
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                    {"--set", "device="},
                                                    {"--set", "max_speed_mps=5.3"},
                                                    {"--set", "drive_timeout_s=0.3"},
                                                    {"--set", "no_such_key=1"}}) {
    Process process(arguments);
    ASSERT_TRUE(play(pty, base, [&] { return process.exit_code().has_value(); }));
    EXPECT_EQ(*process.exit_code(), 2);
  }
}

}  // namespace
}  // namespace nodmap::kurt
