// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

/// The actions that the supervisor requests from the deputy.
struct StartCommand {
  std::string id;
  std::string exec;
};
struct SignalCommand {
  std::string id;
  int signal = 0;  ///< for all processes of the command's tree
};
struct WriteOutput {
  std::string id;  ///< of the command; empty: the deputy itself
  std::string text;
};
struct ForgetCommand {
  std::string id;  ///< not running, and no longer wanted
};
struct PublishInfo {};
struct RefuseOrder {
  const char* cause = "";  ///< the name under which it is counted
  std::string reason;      ///< a sentence for people
};

using SupervisorAction =
    std::variant<StartCommand, SignalCommand, WriteOutput, ForgetCommand, PublishInfo, RefuseOrder>;
using SupervisorActions = std::vector<SupervisorAction>;

/// The logic of a deputy as a pure state machine: orders, process ends and time in, actions out.
/// The deputy performs the actions in order, and answers each StartCommand with started(),
/// not_started() or refused().
class Supervisor {
 public:
  static constexpr time::Duration kMaxOrdersAge = 60s;
  static constexpr time::Duration kMinRespawnDelay = 10ms;
  static constexpr time::Duration kMaxRespawnDelay = 1s;
  /// SIGKILL is repeated with this period until the tree is empty. One is enough, unless a process
  /// sleeps in the kernel.
  static constexpr time::Duration kKillPeriod = 100ms;

  /// More commands than this, in one message or in all together, are refused; a robot has far fewer
  /// processes.
  static constexpr std::size_t kMaxCommands = 1000;
  /// Longest PM_INFO, by a cautious estimate. Receivers refuse messages longer than 256 KiB.
  static constexpr std::size_t kMaxInfoBytes = std::size_t{200} << 10U;

  /// With `trusts_orders` it does as the existing procman: commands that orders omit are stopped
  /// and forgotten, and orders determine how a process is stopped. Without it, omitted commands
  /// continue until they are stopped by name, and a process is stopped within a minute, with a
  /// signal that ends it.
  Supervisor(std::string deputy_id, bool trusts_orders)
      : deputy_id_(std::move(deputy_id)), trusts_orders_(trusts_orders) {}

  /// `age`: how long ago the orders were sent, by the wall clocks.
  [[nodiscard]] SupervisorActions take_orders(const Orders& orders, time::Duration age,
                                              time::SteadyTime now);

  void started(const std::string& id, std::int32_t pid, time::SteadyTime now);
  /// The process could not be created; counts as an end with code 127.
  [[nodiscard]] SupervisorActions not_started(const std::string& id, const std::string& reason,
                                              time::SteadyTime now);

  /// The exec line is not permitted. The same as not_started(), but the command is not started
  /// again before retry_refused() or another order: it would be refused, and reported, each time.
  [[nodiscard]] SupervisorActions refused(const std::string& id, const std::string& reason,
                                          time::SteadyTime now);
  /// Other exec lines are permitted now: refused commands that respawn are due.
  void retry_refused(time::SteadyTime now);

  /// The process of a command and its whole tree have ended.
  [[nodiscard]] SupervisorActions ended(const std::string& id, int wait_status,
                                        time::SteadyTime now);

  /// The actions that are due: SIGKILL after a grace time, respawns.
  [[nodiscard]] SupervisorActions poll(time::SteadyTime now);

  /// When poll() must be called next.
  [[nodiscard]] std::optional<time::SteadyTime> next_due() const;

  /// Stops every command with its signal and grace time, and ignores orders from now on. A second
  /// call kills at once.
  [[nodiscard]] SupervisorActions shut_down(time::SteadyTime now);

  [[nodiscard]] bool is_idle() const;  ///< no process runs
  [[nodiscard]] bool is_shutting_down() const { return is_shutting_down_; }

  /// Every command in the order of its id, including those never started. Without CPU and memory.
  [[nodiscard]] std::vector<CommandStatus> statuses() const;
  /// The runs of all running commands.
  [[nodiscard]] std::vector<CommandRun> runs(time::SteadyTime now) const;

 private:
  struct Entry {
    CommandSpec spec;
    std::int32_t pid = 0;
    std::int32_t actual_run = 0;
    int wait_status = 0;
    bool is_wanted = false;   // should run, so it respawns
    bool is_removed = false;  // to be forgotten when it has ended
    bool is_refused = false;
    time::SteadyTime started{};
    std::int64_t num_starts = 0;
    time::Duration respawn_delay = kMinRespawnDelay;
    std::optional<time::SteadyTime> respawn_due;
    std::optional<time::SteadyTime> kill_due;  // while stopping: when SIGKILL is due
  };

  void obey(const CommandOrder& order, time::SteadyTime now, SupervisorActions& actions);
  [[nodiscard]] bool has_room_for(const CommandSpec& spec) const;
  [[nodiscard]] CommandSpec checked(CommandSpec spec) const;
  bool update_spec(Entry& entry, const CommandSpec& spec);
  void remove_missing(const std::set<std::string_view>& ordered, time::SteadyTime now,
                      SupervisorActions& actions);
  std::map<std::string, Entry>::iterator forget(std::map<std::string, Entry>::iterator at);
  static void start(Entry& entry, std::int32_t run, time::SteadyTime now,
                    SupervisorActions& actions);
  static void schedule_respawn(Entry& entry, time::SteadyTime now);
  static void stop(Entry& entry, time::SteadyTime now, SupervisorActions& actions);

  std::string deputy_id_;
  bool trusts_orders_;
  std::map<std::string, Entry> commands_;
  std::size_t text_bytes_ = 0;  // of all descriptions
  bool is_shutting_down_ = false;
};

}  // namespace nodmap::procman
