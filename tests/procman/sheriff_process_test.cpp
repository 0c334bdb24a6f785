// SPDX-License-Identifier: BSD-3-Clause
// nodmap-sheriff and nodmap-deputy together, used as by people and scripts.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/core/noncopyable.hpp>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "nodmap/status_t.hpp"
#include "tests/procman/sheriff_fixture.hpp"

namespace nodmap {
namespace sheriff_process_test {

using test::kPatience;
using test::kProcmanUrl;
using test::run_program;
using test::SheriffProcess;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The row of a command in the status.
nlohmann::json row_of(const nlohmann::json& status, const std::string& command) {
  for (const nlohmann::json& row : status.at("commands")) {
    if (row.at("command") == command) {
      return row;
    }
  }
  ADD_FAILURE() << "no row of " << command << " in " << status;
  return nlohmann::json::object();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line) && !in.eof();) {  // whole ones
    lines.push_back(line);
  }
  return lines;
}

TEST_F(SheriffProcess, RunsAScriptAndEndsWhileTheCommandsKeepRunning) {
  begin_deputy();
  const auto up = sheriff({"--script", "up", "--timeout", "60"});
  EXPECT_EQ(up.exit_code, 0) << up.out << up.err;
  EXPECT_THAT(up.out, HasSubstr("script up is done"));
  EXPECT_TRUE(
      client_.wait_until([this] { return client_.runs("sleeper") && client_.runs("talker"); }));
  const auto down = sheriff({"--script", "down", "--timeout", "60"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  EXPECT_THAT(test::processes_marked(mark_), IsEmpty());
}

TEST_F(SheriffProcess, AScriptThatCannotBeCompletedFailsAfterItsTimeout) {
  begin_deputy();
  const auto never = sheriff({"--script", "never", "--timeout", "3"});
  EXPECT_EQ(never.exit_code, 1);
  EXPECT_THAT(never.out, HasSubstr("cmd \"far\" to be running"));
  EXPECT_EQ(sheriff({"--script", "none"}).exit_code, 2);
}

TEST_F(SheriffProcess, AScriptFailsIfAStartedCommandHasEnded) {
  begin_deputy();
  const auto dead = sheriff({"--script", "dead", "--timeout", "60"});
  EXPECT_EQ(dead.exit_code, 1) << dead.out << dead.err;
  EXPECT_THAT(dead.out, HasSubstr("script dead has failed: wrong has ended (exit 3)"));
}

TEST_F(SheriffProcess, StartsStopsAndRestartsByName) {
  begin_deputy();
  const auto start = sheriff({"--start", "g"});
  EXPECT_EQ(start.exit_code, 0) << start.out << start.err;
  ASSERT_TRUE(client_.wait_until([this] { return client_.runs("sleeper"); }));
  const int pid = client_.status("sleeper").pid;
  const auto restart = sheriff({"--restart", "sleeper"});
  EXPECT_EQ(restart.exit_code, 0) << restart.out << restart.err;
  ASSERT_TRUE(client_.wait_until(
      [&] { return client_.runs("sleeper") && client_.status("sleeper").pid != pid; }));
  EXPECT_TRUE(client_.runs("talker")) << "the other command still runs";
  const auto stop = sheriff({"--stop", "talker"});
  EXPECT_EQ(stop.exit_code, 0) << stop.out << stop.err;
  EXPECT_TRUE(client_.wait_until([this] { return !client_.runs("talker"); }));
  EXPECT_TRUE(client_.wait_for_infos(3));
  EXPECT_FALSE(client_.runs("talker")) << "it stays stopped";
  EXPECT_TRUE(client_.runs("sleeper"));
  const auto wrong = sheriff({"--start", "wrong"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.out, HasSubstr("wrong: Stopped (Error)"));
  EXPECT_EQ(sheriff({"--start", "nobody"}).exit_code, 2);
  const auto far = sheriff({"--start", "far"});
  EXPECT_EQ(far.exit_code, 1);
  EXPECT_THAT(far.err, HasSubstr("absent does not answer"));
}

TEST_F(SheriffProcess, PrintsTheStatusAsATableAndAsJson) {
  begin_deputy();
  ASSERT_EQ(sheriff({"--start", "talker"}).exit_code, 0);
  const auto table = sheriff({"--status"});
  EXPECT_EQ(table.exit_code, 1) << "one host does not answer";
  EXPECT_THAT(table.out, HasSubstr("g/talker"));
  EXPECT_THAT(table.out, HasSubstr("Running"));
  const auto json = nlohmann::json::parse(sheriff({"--status", "--json"}).out);
  EXPECT_EQ(json["commands"].size(), 4U);
  const nlohmann::json talker = row_of(json, "talker");
  EXPECT_EQ(talker["state"], "Running");
  EXPECT_GT(talker["pid"], 0);
}

// A sheriff that starts later has seen neither the start nor the restart.
TEST_F(SheriffProcess, ReportsTheAgeOfARunAndTheNumberOfRestarts) {
  begin_deputy();
  ASSERT_EQ(sheriff({"--start", "talker"}).exit_code, 0);
  const auto before_restart = std::chrono::steady_clock::now();
  ASSERT_EQ(sheriff({"--restart", "talker"}).exit_code, 0);
  const auto after_restart = std::chrono::steady_clock::now();
  const auto seconds_since = [](std::chrono::steady_clock::time_point moment) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - moment).count();
  };
  ASSERT_EQ(sheriff({"--status"}).exit_code, 1);  // takes some seconds
  const double least_s = seconds_since(after_restart);
  const auto json = nlohmann::json::parse(sheriff({"--status", "--json"}).out);
  const double most_s = seconds_since(before_restart);
  const nlohmann::json talker = row_of(json, "talker");
  EXPECT_EQ(talker["restarts"], 1);
  EXPECT_GE(talker["uptime_s"], least_s);
  EXPECT_LE(talker["uptime_s"], most_s);
}

// Lines with numbers, up to three hundred a second: none is missing, and none comes twice.
TEST_F(SheriffProcess, PrintsTheLastOutputOfACommandAndThenWhatFollows) {
  run_script_as_talker("for ((i = 0; ; ++i)); do echo $i; sleep 0.003; done");
  begin_task("--output talker");
  constexpr std::size_t kLines = 200;
  const auto lines = [this] { return lines_of(printed()); };
  ASSERT_TRUE(client_.wait_until([&] { return lines().size() > kLines; })) << printed();
  const std::vector<std::string> all = lines();
  const int first = std::stoi(all.front());
  for (std::size_t i = 0; i < kLines; ++i) {
    ASSERT_EQ(all[i], std::to_string(first + static_cast<int>(i)) + "\r");
  }
  sheriff_->send_signal(SIGINT);
  EXPECT_EQ(sheriff_->wait_for_end(kPatience), 0);
}

// It is running, and has written its last line before anybody listened.
TEST_F(SheriffProcess, PrintsTheLastOutputOfACommandThatIsSilent) {
  run_script_as_talker("printf '\\033[32mthe address\\033[m\\n'; exec sleep 1000");
  ASSERT_TRUE(client_.wait_until(
      [this] { return client_.output("talker").find("address") != std::string::npos; }));
  begin_task("--output talker");
  EXPECT_TRUE(client_.wait_until([this] { return has_printed("address"); }));
  sheriff_->send_signal(SIGTERM);
  EXPECT_EQ(sheriff_->wait_for_end(kPatience), 0);
  EXPECT_EQ(printed(), "the address\r\n") << "a file gets no colours";
}

TEST_F(SheriffProcess, SaysWhyThereIsNoOutput) {
  const auto follower = sheriff({"--output", "far"});
  EXPECT_EQ(follower.exit_code, 1);
  EXPECT_THAT(follower.err, HasSubstr("the deputy absent does not answer"));
}

// The commands keep running, and the next sheriff finds them as they are.
TEST_F(SheriffProcess, KillingItStopsNoCommand) {
  begin_both();
  const int pid = client_.status("sleeper").pid;
  sheriff_->send_signal(SIGKILL);
  ASSERT_EQ(sheriff_->wait_for_end(kPatience), 128 + SIGKILL);
  EXPECT_TRUE(client_.wait_for_infos(4));
  EXPECT_EQ(client_.status("sleeper").pid, pid);
  const auto up = sheriff({"--script", "up", "--timeout", "60"});
  EXPECT_EQ(up.exit_code, 0);
  EXPECT_EQ(client_.status("sleeper").pid, pid) << "taken over, not started again";
}

TEST_F(SheriffProcess, AnEditedConfigurationIsReadAndUnchangedCommandsKeepRunning) {
  begin_both();
  const int sleeper = client_.status("sleeper").pid;
  const int talker = client_.status("talker").pid;
  std::ofstream(file_) << R"(cmd "sleeper" { exec = ")" << marked("sleep 1000")
                       << R"("; host = "rover"; auto_respawn = "true"; }
      cmd "talker" { exec = ")"
                       << marked("sleep 2000") << R"("; host = "rover"; }
      cmd "new" { exec = ")"
                       << marked("sleep 3000") << R"("; host = "rover"; })";
  EXPECT_TRUE(client_.wait_until(
      [&] { return client_.runs("talker") && client_.status("talker").pid != talker; }));
  EXPECT_THAT(client_.status("talker").spec.exec, HasSubstr("sleep 2000"));
  EXPECT_EQ(client_.status("sleeper").pid, sleeper) << "it has not changed";
  EXPECT_FALSE(client_.runs("new"));
  sheriff_->send_signal(SIGTERM);
  EXPECT_EQ(sheriff_->wait_for_end(kPatience), 0);
  EXPECT_EQ(sheriff({"--start", "new"}).exit_code, 0) << "the deputy has read it as well";
}

TEST_F(SheriffProcess, RestartsACommandWhoseStatusIsFailed) {
  begin_both();
  const int pid = client_.status("sleeper").pid;
  nodmap::status_t status{};
  status.process_name = "sleeper";
  status.health = nodmap::status_t::FAILED;
  status.health_reason = "asleep";
  EXPECT_TRUE(client_.wait_until([&] {
    client_.bus().publish("STATUS", status);
    ::usleep(100'000);
    return client_.runs("sleeper") && client_.status("sleeper").pid != pid;
  }));
  sheriff_->send_signal(SIGTERM);
  EXPECT_EQ(sheriff_->wait_for_end(kPatience), 0);
}

// A program on a terminal of its own, of 80 x 24 characters; what it draws is collected.
class OnATerminal : boost::noncopyable {
 public:
  explicit OnATerminal(std::vector<std::string> command) {
    winsize size{};
    size.ws_row = 24;
    size.ws_col = 80;
    pid_ = ::forkpty(&fd_, nullptr, nullptr, &size);
    if (pid_ == 0) {
      std::vector<char*> words;
      for (std::string& word : command) {
        words.push_back(word.data());
      }
      words.push_back(nullptr);
      ::execv(words[0], words.data());
      ::_exit(127);
    }
    ::fcntl(fd_, F_SETFL, O_NONBLOCK);
  }
  ~OnATerminal() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(fd_);
  }

  void type(const std::string& keys) {
    EXPECT_EQ(::write(fd_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  // Everything that was drawn so far.
  const std::string& drawn() {
    std::array<char, 4096> buffer{};
    for (ssize_t size = 1; size > 0;) {
      size = ::read(fd_, buffer.data(), buffer.size());
      drawn_.append(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(0, size)));
    }
    return drawn_;
  }
  [[nodiscard]] bool ends_with(int code) {
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) != pid_) {
      return false;
    }
    pid_ = -1;
    return WIFEXITED(status) && WEXITSTATUS(status) == code;
  }

 private:
  pid_t pid_ = -1;
  int fd_ = -1;
  std::string drawn_;
};

TEST_F(SheriffProcess, TheLiveViewObeysKeysAndRestoresTheTerminal) {
  begin_deputy();
  OnATerminal view({NODMAP_BIN "/nodmap-sheriff", file_, "--lcm-url", kProcmanUrl});
  // Reads what is drawn all the time, because a terminal that nobody reads blocks the program.
  const auto becomes = [&](const std::function<bool()>& condition) {
    return client_.wait_until([&] {
      view.drawn();
      return condition();
    });
  };
  const auto shows = [&](const std::string& text) {
    return becomes([&] { return view.drawn().find(text) != std::string::npos; });
  };
  ASSERT_TRUE(shows("looking for other sheriffs"));
  view.type("jj");  // down to the first command of the group
  EXPECT_TRUE(becomes([&] {
    view.type("S");  // until it gives orders
    return client_.wait_for_infos(1) && client_.runs("sleeper") && client_.runs("talker");
  })) << "starts the whole group of the selected command";
  EXPECT_TRUE(shows("--- sleeper: Running"));
  view.type("j");
  EXPECT_TRUE(shows("--- talker: Running"));
  EXPECT_TRUE(shows("word")) << "its output";
  EXPECT_TRUE(becomes([&] {
    view.type("\x1B[5~");  // until there is more output than lines
    return view.drawn().find("lines below") != std::string::npos;
  })) << "scrolled back";
  const int pid = client_.status("talker").pid;
  view.type("r");
  EXPECT_TRUE(
      becomes([&] { return client_.runs("talker") && client_.status("talker").pid != pid; }));
  view.type("t");
  EXPECT_TRUE(becomes([&] { return !client_.runs("talker"); }));
  EXPECT_TRUE(client_.runs("sleeper"));
  view.type("1");
  EXPECT_TRUE(becomes([&] { return client_.runs("talker"); })) << "the first script starts it";
  EXPECT_TRUE(shows("script up is done"));
  view.type("q");
  EXPECT_TRUE(becomes([&] { return view.ends_with(0); }));
  EXPECT_THAT(view.drawn(), ::testing::EndsWith("\x1B[?25h\x1B[?1049l"));
  EXPECT_TRUE(client_.runs("sleeper")) << "the commands keep running";
}

TEST_F(SheriffProcess, KeysOfAnObserverGiveNoOrders) {
  begin_deputy();
  OnATerminal view({NODMAP_BIN "/nodmap-sheriff", file_, "--lcm-url", kProcmanUrl, "--observe"});
  EXPECT_TRUE(client_.wait_until([&] {
    view.type("s");
    return client_.wait_for_infos(1) &&
           view.drawn().find("observing only: no orders") != std::string::npos;
  }));
  EXPECT_THAT(test::processes_marked(mark_), IsEmpty());
}

TEST(SheriffCheck, PrintsTheConfigurationOrItsErrors) {
  const test::TemporaryDir dir;
  const std::string file = dir.path() / "x.pmd";
  std::ofstream(file) << "group \"g\" { cmd \"a\" { exec = \"x\"; } }\nscript \"s\" { }\n";
  const auto good = run_program("nodmap-sheriff", {file, "--check"});
  EXPECT_EQ(good.exit_code, 0);
  EXPECT_THAT(good.out, HasSubstr("1 commands, 1 groups, 1 scripts"));
  // A health rule that is missing shows by that.
  std::ofstream(file) << "cmd \"a\" { exec = \"x\";\n #nodmap: restart_silent_s = 5; nice = 7;\n"
                         " # nodmap: restart_failed_s = 6;\n}";
  EXPECT_THAT(run_program("nodmap-sheriff", {file, "--check"}).out,
              HasSubstr("#nodmap: restart_silent_s = 5; nice = 7;\n"));
  std::ofstream(file) << "cmd \"a\" {\n  exe = \"x\";\n}";
  const auto bad = run_program("nodmap-sheriff", {file, "--check"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_EQ(bad.err, file + ":2:3: unrecognized attribute exe\n");
}

}  // namespace sheriff_process_test
}  // namespace nodmap
