// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nodmap::test {

/// Longest wait for an event that takes milliseconds or seconds on an idle machine. A test that
/// passes never waits this long.
inline constexpr std::chrono::milliseconds kPatience{120'000};

/// A program started by a test. The destructor kills it if it is still running.
class ChildProcess : private boost::noncopyable {
 public:
  struct Options {
    std::optional<std::uint64_t> max_file_bytes = std::nullopt;  ///< RLIMIT_FSIZE
  };

  /// `command` is the program, looked up in PATH, and its arguments.
  explicit ChildProcess(const std::vector<std::string>& command)
      : ChildProcess(command, Options{}) {}
  ChildProcess(const std::vector<std::string>& command, const Options& options);
  ~ChildProcess();

  /// Reads its stderr until `text` appears. Returns false if it does not appear in time.
  [[nodiscard]] bool wait_for_stderr(const std::string& text, std::chrono::milliseconds timeout);

  /// Closes our end of its stderr, like a reader that has ended.
  void stop_reading();

  void send_signal(int signal) const;

  /// Its exit code, or 128 plus the signal that ended it; empty if it does not end in time. May be
  /// called again.
  [[nodiscard]] std::optional<int> wait_for_end(std::chrono::milliseconds timeout);

  [[nodiscard]] const std::string& said() const { return said_; }

 private:
  [[nodiscard]] bool read_some(std::chrono::milliseconds timeout);

  pid_t pid_ = -1;
  std::optional<int> exit_code_;
  int stderr_fd_ = -1;
  std::string said_;
};

}  // namespace nodmap::test
