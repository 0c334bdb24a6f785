// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

enum class CommandState : std::uint8_t {
  kUnknown,  ///< its deputy has not been heard, or not for long
  kStarting,
  kRunning,
  kRestarting,
  kStopping,
  kStoppedOk,
  kStoppedError,
};

/// As people and the existing sheriff say it: "Running", "Stopped (Error)", ...
[[nodiscard]] const char* name_of(CommandState state);

/// How a wait status reads: "exit 3", "killed by signal 9 (Killed)"; empty for a clean end.
[[nodiscard]] std::string describe_end(int wait_status);

/// How a sheriff of this process names itself, but for the time at which it began: "host:process:".
[[nodiscard]] std::string sheriff_id_prefix();

/// A sheriff's side of the protocol: what it wants of the commands, against what their deputies
/// report. Pure.
class Fleet {
 public:
  /// An INFO that is older says nothing any more (30 s in the existing sheriff; here the three that
  /// can be lost, so that a dead host is seen before anyone waits for it).
  static constexpr time::Duration kMaxInfoAge = 5s;
  /// Two INFOs so far apart have a gap between them, in which STATUS may have been lost, too.
  static constexpr time::Duration kInfoGap = 1500ms;
  /// So long after its orders another sheriff counts as being there.
  static constexpr time::Duration kOtherSheriffTime = 3s;

  /// What its deputy says of a run.
  struct Run {
    std::int32_t pid = 0;
    time::SteadyTime started{};
    std::int64_t num_restarts = 0;
  };

  struct Item {
    CommandSpec spec;
    std::string deputy;
    std::int32_t desired_run = 0;
    bool force_quit = false;
    bool stop_ordered = false;  ///< an end by a stop signal is what was wanted
    bool adopted = false;       ///< a first INFO has told what ran before us
    bool configured = false;    ///< in our file; others are the deputies' and left as they are
    std::optional<CommandStatus> status;
    time::SteadyTime running_since{};
    std::int64_t num_restarts = 0;    ///< seen by this sheriff: each new process after the first
    std::optional<Run> reported_run;  ///< by deputies of ours; of the process that runs
    /// Wait status of the newest end with an error that nobody ordered, since the last start order.
    std::optional<std::int32_t> failed_status;
  };

  struct DeputyItem {
    DeputyInfo info;
    time::SteadyTime heard{};        ///< the newest INFO
    time::SteadyTime heard_since{};  ///< since then without a gap
  };

  Fleet(const Config& config, std::string sheriff_id);

  /// The configuration was edited: what it does not name any more is stopped, what is new waits to
  /// be started, a command that runs by another exec line is restarted, and all else goes on. What
  /// has changed, for people, a line each.
  std::vector<std::string> reconfigure(const Config& config);

  // What is wanted from now on. Unknown names do nothing.
  void order(Verb verb, const std::string& id);
  void start(const std::string& id);
  void stop(const std::string& id);
  void restart(const std::string& id);

  /// What a deputy says. Whether there are new orders for it that should not wait.
  bool take_info(const DeputyInfo& info, time::SteadyTime now);
  /// What a deputy of ours says besides, after its INFO.
  void take_runs(const Runs& runs, time::SteadyTime now);
  /// Orders as heard on the network: ours, or another sheriff's.
  void take_orders(const Orders& orders, time::SteadyTime now);

  /// Whether the configuration has commands for a deputy. Others on the same network are not ours.
  [[nodiscard]] bool commands(const std::string& deputy) const;

  /// All that is wanted of a deputy of ours; nothing before it was heard, for then it is not known
  /// what runs there.
  [[nodiscard]] std::optional<Orders> orders_for(const std::string& deputy,
                                                 time::Timestamp stamp) const;

  [[nodiscard]] CommandState state_of(const std::string& id, time::SteadyTime now) const;
  /// Whether a script's wait for this is over.
  [[nodiscard]] bool has_reached(const std::string& id, Wanted wanted, time::SteadyTime now) const;

  /// The other sheriff, if one gave orders lately.
  [[nodiscard]] std::optional<std::string> other_sheriff(time::SteadyTime now) const;

  /// Whether it is we who give way to it: the one that began later does, and always we to one whose
  /// beginning is not known.
  [[nodiscard]] bool must_yield(time::SteadyTime now) const;
  [[nodiscard]] const std::string& sheriff_id() const { return sheriff_id_; }

  [[nodiscard]] const std::vector<Item>& items() const { return items_; }
  [[nodiscard]] const Item* find(const std::string& id) const;
  /// The deputies of the configuration and those heard.
  [[nodiscard]] const std::map<std::string, std::optional<DeputyItem>>& deputies() const {
    return deputies_;
  }
  [[nodiscard]] bool is_heard(const std::string& deputy, time::SteadyTime now) const;

  /// The present run of a command as its deputy reports it, else as far as this sheriff has seen
  /// it.
  [[nodiscard]] static Run run_of(const Item& item);

 private:
  [[nodiscard]] Item* find_mutable(const std::string& id);
  static void begin_run(Item& item);
  static void adopt(Item& item, const CommandStatus& status);
  static void take_status(Item& item, const CommandStatus& status, time::SteadyTime now);

  std::string sheriff_id_;
  std::vector<Item> items_;
  std::map<std::string, std::optional<DeputyItem>> deputies_;
  std::string other_sheriff_;
  time::SteadyTime other_heard_{};
};

}  // namespace nodmap::procman
