// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "drivers/kurt/test/kurt_emulator.hpp"
#include "tests/support/pty_pair.hpp"

namespace nodmap::test {

/// A child process, killed at the latest with this object.
class Process {
 public:
  explicit Process(std::vector<std::string> command);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  Process(Process&&) = delete;
  Process& operator=(Process&&) = delete;

  void signal(int number) const;

  /// Its exit code, or 128 + the signal that killed it; empty while it lives.
  [[nodiscard]] std::optional<int> exit_code();

 private:
  int pid_;
  std::optional<int> exit_code_;
};

/// Plays the base in real time until `done`; gives up after 20 s.
template <class Condition>
bool play(PtyPair& pty, KurtEmulator& base, Condition done) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  auto next_tick = std::chrono::steady_clock::now();
  while (!done() && std::chrono::steady_clock::now() < deadline) {
    const std::string answer = base.take(pty.receive_text(1, std::chrono::milliseconds(10)));
    std::string frames;
    for (; next_tick <= std::chrono::steady_clock::now();
         next_tick += std::chrono::milliseconds(10)) {
      frames += base.tick();
    }
    if (!(answer + frames).empty()) {
      pty.send(answer + frames);
    }
  }
  return done();
}

}  // namespace nodmap::test
