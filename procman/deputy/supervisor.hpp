// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

/// What the supervisor asks of its shell.
struct StartCommand {
  std::string id;
  std::string exec;
};
struct SignalCommand {
  std::string id;
  int signal = 0;  ///< for the process and all that descends from it
};
struct WriteOutput {
  std::string id;  ///< of the command; empty: the deputy itself
  std::string text;
};
struct ForgetCommand {
  std::string id;  ///< does not run, and is not wanted any more
};
struct PublishInfo {};

using SupervisorAction =
    std::variant<StartCommand, SignalCommand, WriteOutput, ForgetCommand, PublishInfo>;
using SupervisorActions = std::vector<SupervisorAction>;

/// What a deputy does, as a pure machine: orders, ends of processes and time in, actions out. The
/// shell carries actions out in their order, and answers each StartCommand by started() or
/// not_started().
class Supervisor {
 public:
  static constexpr time::Duration kMaxOrdersAge = 60s;
  static constexpr time::Duration kMinRespawnDelay = 10ms;
  static constexpr time::Duration kMaxRespawnDelay = 1s;
  /// A tree that SIGKILL did not empty is struck again so often; only what sleeps in the kernel
  /// takes longer.
  static constexpr time::Duration kKillPeriod = 100ms;

  /// More commands than a robot has processes: orders that name more are ignored.
  static constexpr std::size_t kMaxCommands = 1000;

  /// Who `trusts` orders stops and forgets what they do not name, and lets them say how a process
  /// is stopped, as the existing procman does. Who does not keeps running what they leave out (each
  /// command is stopped by name), ends processes by signals that end them, and within a minute.
  Supervisor(std::string deputy_id, bool trusts_orders)
      : deputy_id_(std::move(deputy_id)), trusts_orders_(trusts_orders) {}

  /// `age` is how long ago the orders were sent, by the wall clocks.
  [[nodiscard]] SupervisorActions take_orders(const Orders& orders, time::Duration age,
                                              time::SteadyTime now);

  void started(const std::string& id, std::int32_t pid, time::SteadyTime now);
  /// The process could not even be made; counts as an end with code 127.
  [[nodiscard]] SupervisorActions not_started(const std::string& id, const std::string& reason,
                                              time::SteadyTime now);

  /// The process of a command has ended, and nothing that descends from it is left to wait for.
  [[nodiscard]] SupervisorActions ended(const std::string& id, int wait_status,
                                        time::SteadyTime now);

  /// What is due: SIGKILL after a grace time, respawns.
  [[nodiscard]] SupervisorActions poll(time::SteadyTime now);

  /// When poll() is next worth calling.
  [[nodiscard]] std::optional<time::SteadyTime> next_due() const;

  /// Stops everything, each with its signal and grace time; from now on no orders are taken. A
  /// second call kills at once.
  [[nodiscard]] SupervisorActions shut_down(time::SteadyTime now);

  [[nodiscard]] bool is_idle() const;  ///< no process runs
  [[nodiscard]] bool is_shutting_down() const { return shutting_down_; }

  /// Every command, by its id: those never started, too. Without what only the system knows.
  [[nodiscard]] std::vector<CommandStatus> statuses() const;
  /// Of those that run.
  [[nodiscard]] std::vector<CommandRun> runs(time::SteadyTime now) const;

 private:
  struct Entry {
    CommandSpec spec;
    std::int32_t pid = 0;
    std::int32_t actual_run = 0;
    int wait_status = 0;
    bool wanted = false;   // should run, hence respawns
    bool removed = false;  // to be forgotten when it has ended
    time::SteadyTime started{};
    std::int64_t num_starts = 0;
    time::Duration respawn_delay = kMinRespawnDelay;
    std::optional<time::SteadyTime> respawn_due;
    std::optional<time::SteadyTime> kill_due;  // while it stops: when SIGKILL is due
  };

  void carry_out(const CommandOrder& order, time::SteadyTime now, SupervisorActions& actions);
  [[nodiscard]] CommandSpec checked(CommandSpec spec) const;
  bool update_spec(Entry& entry, const CommandSpec& spec);
  void remove_missing(const Orders& orders, time::SteadyTime now, SupervisorActions& actions);
  static void start(Entry& entry, std::int32_t run, time::SteadyTime now,
                    SupervisorActions& actions);
  static void schedule_respawn(Entry& entry, time::SteadyTime now);
  static void stop(Entry& entry, time::SteadyTime now, SupervisorActions& actions);

  std::string deputy_id_;
  bool trusts_orders_;
  std::map<std::string, Entry> commands_;
  bool shutting_down_ = false;
};

}  // namespace nodmap::procman
