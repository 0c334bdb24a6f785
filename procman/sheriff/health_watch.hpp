// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/bus/sender.hpp"
#include "common/bus/sender_watch.hpp"
#include "common/geometry/time.hpp"
#include "common/node/health.hpp"
#include "common/node/status.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/fleet.hpp"

namespace nodmap::procman {

/// The health of a process from its STATUS.
struct ProcessHealth {
  using State = node::HealthState;
  State state = State::kOk;
  std::string reason;
  double handled_per_s = 0.0;
  double latency_p50_us = 0.0;
  double latency_p99_us = 0.0;
  std::int64_t lost = 0;
  std::int64_t rejected = 0;
};

[[nodiscard]] const char* name_of(ProcessHealth::State state);

/// Applies the health rules of the configuration: finds the commands that must be restarted, by the
/// STATUS of their processes and by their output.
///
/// The STATUS of a command's process is taken from one socket of its host: from the first that
/// sends it after the process was started, until that has been silent for node::kStatusSilence. So
/// no other process can have it restarted, or hide that it fails.
class HealthWatch {
 public:
  /// Each restart doubles the limits of the rules, up to this often: a command that a restart does
  /// not fix must not keep the robot busy. A minute without a fault restores them.
  static constexpr int kMaxDoublings = 5;
  static constexpr time::Duration kForgiveTime = 60s;

  explicit HealthWatch(const Config& config) : config_(config) {}

  void take_status(const std::string& process_name, const ProcessHealth& health, const Fleet& fleet,
                   time::SteadyTime now, const bus::Sender& sender = {});
  /// To be called when a command has written output.
  void take_output(const std::string& command_id, time::SteadyTime now);

  struct LastStatus {
    ProcessHealth health;
    time::SteadyTime received{};
  };
  /// The newest STATUS of a command's process; empty if none was received.
  [[nodiscard]] std::optional<LastStatus> last_status_of(const std::string& command_id) const;

  /// The process names under which a second process sends STATUS.
  [[nodiscard]] std::set<std::string> contested_names(time::SteadyTime now) const;

  struct Restart {
    std::string command_id;
    std::string reason;
  };
  /// The running commands that must be restarted now. Each counts as restarted from here on.
  [[nodiscard]] std::vector<Restart> due_restarts(const Fleet& fleet, time::SteadyTime now);

 private:
  struct Process {
    std::optional<LastStatus> last;
    std::optional<time::SteadyTime> failed_since;
    std::optional<time::SteadyTime> degraded_since;  // or failed
    bus::SenderWatch sender{node::kStatusSilence};
  };
  struct Patience {
    int doublings = 0;
    time::SteadyTime restarted{};
  };
  /// The time over which a rule observes a command. It ends where the deputy is not received any
  /// more: a broken link is not a fault of the process.
  struct Span {
    time::SteadyTime since{};
    time::SteadyTime until{};
  };
  [[nodiscard]] Process* process_of(const std::string& process_name, const Fleet& fleet,
                                    time::SteadyTime now, const bus::Sender& sender);
  [[nodiscard]] std::string restart_reason(const Command& command, Span observed, int factor) const;

  const Config& config_;
  std::map<std::string, Process> processes_;         // by command
  std::map<std::string, time::SteadyTime> written_;  // by command: when it last wrote output
  std::map<std::string, Patience> patience_;
};

}  // namespace nodmap::procman
