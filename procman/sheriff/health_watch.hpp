// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "procman/config/config.hpp"
#include "procman/sheriff/fleet.hpp"

namespace nodmap::procman {

/// What a process says of itself in STATUS.
struct ProcessHealth {
  enum class State : std::uint8_t { kOk, kDegraded, kFailed };
  State state = State::kOk;
  std::string reason;
  double handled_per_s = 0.0;
  double latency_p50_us = 0.0;
  double latency_p99_us = 0.0;
  std::int64_t lost = 0;
  std::int64_t rejected = 0;
};

[[nodiscard]] const char* name_of(ProcessHealth::State state);

/// The process_name by which a command speaks in STATUS: by its rule, else the program of its exec.
[[nodiscard]] std::string status_name(const Command& command);

/// Joins what processes say in STATUS to the commands that run them, and tells which commands are
/// to be restarted by the rules of the configuration.
class HealthWatch {
 public:
  /// After each restart the patience doubles, so often; a command that cannot be helped must not
  /// keep the robot busy. It is as at first when the command has been well for a minute.
  static constexpr int kMaxDoublings = 5;
  static constexpr std::int64_t kForgiveUs = 60'000'000;

  explicit HealthWatch(const Config& config) : config_(config) {}

  void take_status(const std::string& process_name, const ProcessHealth& health,
                   std::int64_t now_us);
  /// A command has written something.
  void take_output(const std::string& command_id, std::int64_t now_us);

  struct Said {
    ProcessHealth health;
    std::int64_t heard_us = 0;
  };
  /// What a command said last in STATUS; nothing when it never did.
  [[nodiscard]] std::optional<Said> said_by(const std::string& command_id) const;

  struct Verdict {
    std::string command_id;
    std::string reason;
  };
  /// What is to be restarted now, of what runs. Counts as done: the next verdict is due later.
  [[nodiscard]] std::vector<Verdict> verdicts(const Fleet& fleet, std::int64_t now_us);

 private:
  struct Voice {
    Said last;
    std::optional<std::int64_t> failed_since_us;
  };
  struct Patience {
    int doublings = 0;
    std::int64_t restarted_us = 0;
  };
  /// The moments by which a command is judged. Only what its deputy was heard over counts: a broken
  /// link is no fault of the process.
  struct Span {
    std::int64_t since_us = 0;
    std::int64_t until_us = 0;
  };
  [[nodiscard]] std::string complaint(const Command& command, Span heard, int factor) const;

  const Config& config_;
  std::map<std::string, Voice> voices_;             // by process name
  std::map<std::string, std::int64_t> written_us_;  // by command: when it last wrote something
  std::map<std::string, Patience> patience_;
};

}  // namespace nodmap::procman
