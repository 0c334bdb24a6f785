// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/fleet.hpp"

namespace nodmap::procman {

/// The health of a process, as in its STATUS.
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

/// Joins each STATUS to the command whose process sent it, and finds the commands that are to be
/// restarted by the health rules of the configuration.
class HealthWatch {
 public:
  /// After each restart the limits of the rules double, at most this often, so that a command which
  /// no restart mends does not keep the robot busy. After a minute without a fault they are as at
  /// first.
  static constexpr int kMaxDoublings = 5;
  static constexpr time::Duration kForgiveTime = 60s;

  explicit HealthWatch(const Config& config) : config_(config) {}

  void take_status(const std::string& process_name, const ProcessHealth& health,
                   time::SteadyTime now);
  /// A command has written something.
  void take_output(const std::string& command_id, time::SteadyTime now);

  struct LastStatus {
    ProcessHealth health;
    time::SteadyTime received{};
  };
  /// The newest STATUS of a command's process; nothing when none came.
  [[nodiscard]] std::optional<LastStatus> last_status_of(const std::string& command_id) const;

  struct Restart {
    std::string command_id;
    std::string reason;
  };
  /// What is to be restarted now, of what runs. Counts as done: the next restart is due later.
  [[nodiscard]] std::vector<Restart> due_restarts(const Fleet& fleet, time::SteadyTime now);

 private:
  struct Process {
    LastStatus last;
    std::optional<time::SteadyTime> failed_since;
    std::optional<time::SteadyTime> degraded_since;  // or failed
  };
  struct Patience {
    int doublings = 0;
    time::SteadyTime restarted{};
  };
  /// The time over which a rule looks at a command: only while its deputy is received, since a
  /// broken link is no fault of the process.
  struct Span {
    time::SteadyTime since{};
    time::SteadyTime until{};
  };
  [[nodiscard]] std::string restart_reason(const Command& command, Span observed, int factor) const;

  const Config& config_;
  std::map<std::string, Process> processes_;         // by process name
  std::map<std::string, time::SteadyTime> written_;  // by command: when it last wrote something
  std::map<std::string, Patience> patience_;
};

}  // namespace nodmap::procman
