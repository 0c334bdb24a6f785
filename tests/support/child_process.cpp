// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <system_error>

namespace nodmap::test {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

milliseconds left_until(SteadyClock::time_point deadline) {
  return std::max(milliseconds(0),
                  std::chrono::duration_cast<milliseconds>(deadline - SteadyClock::now()));
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const Options& options) {
  std::vector<char*> arguments;
  for (const std::string& word : command) {
    arguments.push_back(const_cast<char*>(word.c_str()));  // NOLINT: execvp's signature is old
  }
  arguments.push_back(nullptr);
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) {
    throw std::system_error(errno, std::system_category(), "pipe");
  }
  // Nobody reads while a test waits for something else, so the pipe has room for a deputy's
  // messages about 200 restarts.
  constexpr int kPipeBytes = 1 << 20;
  ::fcntl(pipe[1], F_SETPIPE_SZ, kPipeBytes);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::dup2(pipe[1], STDERR_FILENO);
    ::close(pipe[0]);
    ::close(pipe[1]);
    if (options.max_file_bytes) {
      const struct rlimit limit { *options.max_file_bytes, *options.max_file_bytes };
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::close(pipe[1]);
  stderr_fd_ = pipe[0];
}

ChildProcess::~ChildProcess() {
  if (!exit_code_) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  stop_reading();
}

bool ChildProcess::wait_for_stderr(const std::string& text, milliseconds timeout) {
  const auto deadline = SteadyClock::now() + timeout;
  while (said_.find(text) == std::string::npos) {
    if (SteadyClock::now() >= deadline || !read_some(left_until(deadline))) {
      return false;
    }
  }
  return true;
}

void ChildProcess::stop_reading() {
  if (stderr_fd_ >= 0) {
    ::close(stderr_fd_);
  }
  stderr_fd_ = -1;  // poll() ignores it
}

void ChildProcess::send_signal(int signal) const {
  ::kill(pid_, signal);
}

std::optional<int> ChildProcess::wait_for_end(milliseconds timeout) {
  if (exit_code_) {
    return exit_code_;
  }
  const auto deadline = SteadyClock::now() + timeout;
  int status = 0;
  while (::waitpid(pid_, &status, WNOHANG) == 0) {
    if (SteadyClock::now() >= deadline) {
      return std::nullopt;
    }
    // Pauses between two checks, and keeps the pipe from filling up.
    if (!read_some(milliseconds(2))) {
      ::usleep(1000);
    }
  }
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  while (read_some(milliseconds(0))) {
  }
  return exit_code_;
}

// Returns false if nothing arrived in time, or if the program has closed its stderr.
bool ChildProcess::read_some(milliseconds timeout) {
  struct pollfd waiting {
    stderr_fd_, POLLIN, 0
  };
  if (::poll(&waiting, 1, static_cast<int>(timeout.count())) <= 0) {
    return false;
  }
  std::array<char, 4096> buffer{};
  const ssize_t size = ::read(stderr_fd_, buffer.data(), buffer.size());
  said_.append(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(0, size)));
  return size > 0;
}

}  // namespace nodmap::test
