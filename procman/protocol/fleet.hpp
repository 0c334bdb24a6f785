// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/sender.hpp"
#include "common/geometry/time.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/command_state.hpp"
#include "procman/protocol/deputy_reports.hpp"
#include "procman/protocol/other_sheriffs.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

/// The id of a sheriff in this process, without the start time at its end: "host:process:".
[[nodiscard]] std::string sheriff_id_prefix();

/// The sheriff's side of the protocol: compares the requested states of the commands with those
/// that their deputies report. Without clock or network.
///
/// It begins without command: until take_command(), and after observe(), it has no orders of its
/// own, and the requested states are those that the deputies report.
class Fleet {
 public:
  /// A deputy starts a command again after a second at most; one more INFO may be lost.
  static constexpr time::Duration kRespawnTime = 3s;

  /// A sheriff that has given orders for this long does not yield. Another one then has not looked
  /// for it, or its network was divided; and anybody can send a message that looks like one.
  static constexpr time::Duration kYieldTime = 10s;

  /// One run of a command.
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
    bool is_stop_ordered = false;  ///< an end by the stop signal is not an error
    bool is_adopted = false;       ///< an INFO has told what ran before this sheriff
    bool is_configured = false;    ///< in our file; all other commands are left alone
    std::optional<CommandStatus> status;
    time::SteadyTime running_since{};
    std::int64_t num_restarts = 0;    ///< new processes after the first that this sheriff saw
    std::optional<Run> reported_run;  ///< the present run, from PM_RUNS
    /// The wait status of the newest failure since the last start order. An ordered end is none.
    std::optional<std::int32_t> failed_status;
    /// Of a command that was adopted between its end and its respawn: if it does not run again by
    /// then, somebody has stopped it.
    std::optional<time::SteadyTime> respawns_until;
  };

  Fleet(const Config& config, std::string sheriff_id);

  /// Adopts an edited configuration. Stops removed commands and restarts running ones whose exec
  /// line has changed; new ones wait to be started, and all others continue. A command that was
  /// moved to another host is stopped on the first, and not started on the second before that has
  /// ended. Returns a line for each change, for people.
  std::vector<std::string> reconfigure(const Config& config);

  // Change the requested state of a command. Unknown names have no effect.
  void order(Verb verb, const std::string& id);
  void start(const std::string& id);
  void stop(const std::string& id);
  void restart(const std::string& id);

  /// Takes the report of a deputy, unless another sender reports for it already. Returns whether it
  /// must be sent orders at once.
  bool take_info(const DeputyInfo& info, time::SteadyTime now, const bus::Sender& sender = {});
  /// Takes the additional report that our deputies send after INFO.
  void take_runs(const Runs& runs, time::SteadyTime now, const bus::Sender& sender = {});
  /// Takes orders received from the network: ours, or another sheriff's.
  void take_orders(const Orders& orders, time::SteadyTime now, const bus::Sender& sender = {});

  /// Whether the configuration has commands for a deputy.
  [[nodiscard]] bool has_commands_for(const std::string& deputy) const;

  /// The orders for a deputy of the configuration. Empty before its first INFO: what runs there is
  /// not known yet.
  [[nodiscard]] std::optional<Orders> orders_for(const std::string& deputy,
                                                 time::Timestamp stamp) const;

  /// The state of a command: on the host that the configuration names, or kStopping while it still
  /// runs on one that it was moved from.
  [[nodiscard]] CommandState state_of(const std::string& id, time::SteadyTime now) const;
  [[nodiscard]] CommandState state_of(const Item& item, time::SteadyTime now) const;
  [[nodiscard]] bool is_running(const std::string& id, time::SteadyTime now) const;
  [[nodiscard]] bool is_stopped(const std::string& id, time::SteadyTime now) const;

  /// The other sheriffs that give orders to our deputies.
  [[nodiscard]] const OtherSheriffs& other_sheriffs() const { return other_sheriffs_; }

  /// This sheriff gives orders from now on.
  void take_command(time::SteadyTime now) { commands_since_ = now; }
  /// It gives none from now on.
  void observe() { commands_since_.reset(); }
  [[nodiscard]] bool is_in_command() const { return commands_since_.has_value(); }
  /// Whether this sheriff must stop giving orders. Of two sheriffs that begin to give orders at the
  /// same time the one that started later must; this one must, if it is not known when the other
  /// started.
  [[nodiscard]] bool must_yield(time::SteadyTime now) const;
  [[nodiscard]] const std::string& sheriff_id() const { return sheriff_id_; }

  [[nodiscard]] const std::vector<Item>& items() const { return items_; }
  /// The item of a command, on the host that the configuration names.
  [[nodiscard]] const Item* find(const std::string& id) const;
  /// The deputies of the configuration and those from which INFO was received.
  [[nodiscard]] const DeputyReports& deputies() const { return deputies_; }

  /// The present run of a command: as its deputy reports it, else as this sheriff has observed it.
  [[nodiscard]] static Run run_of(const Item& item);

 private:
  [[nodiscard]] Item* find_or_add(const CommandSpec& spec, const std::string& deputy);
  [[nodiscard]] static std::optional<Item> take_item(std::vector<Item>& items,
                                                     const Command& command);
  [[nodiscard]] static Item configure(std::optional<Item> before, const Command& command,
                                      std::vector<std::string>& changes);
  [[nodiscard]] bool waits_for_former_host(const Item& item) const;
  static void begin_run(Item& item);
  static void forget_orders(Item& item);
  static void adopt(Item& item, const CommandStatus& status, time::SteadyTime now);
  static void take_status(Item& item, const CommandStatus& status, time::SteadyTime now);

  std::string sheriff_id_;
  std::vector<Item> items_;
  DeputyReports deputies_;
  time::SteadyTime newest_info_{};  // when it was received
  OtherSheriffs other_sheriffs_;
  std::optional<time::SteadyTime> commands_since_;  // empty: it gives no orders
};

}  // namespace nodmap::procman
