// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/config/config.hpp"

namespace nodmap::procman {

/// The channels of the protocol.
inline constexpr const char* kDiscoverChannel = "PM_DISCOVER";
inline constexpr const char* kInfoChannel = "PM_INFO";
inline constexpr const char* kOrdersChannel = "PM_ORDERS";
inline constexpr const char* kOutputChannel = "PM_OUTPUT";
/// Extensions that the existing tools do not know.
inline constexpr const char* kRunsChannel = "PM_RUNS";
inline constexpr const char* kLastOutputChannel = "PM_LAST_OUTPUT";

/// A command as described in the messages of sheriff and deputy.
struct CommandSpec {
  std::string id;
  std::string exec;
  std::string group;
  bool auto_respawn = false;
  int stop_signal = Command::kDefaultStopSignal;
  double stop_time_allowed_s = Command::kDefaultStopTimeS;

  bool operator==(const CommandSpec&) const = default;
};

/// The requested state of one command.
struct CommandOrder {
  CommandSpec spec;
  std::int32_t desired_run = 0;
  bool force_quit = false;

  bool operator==(const CommandOrder&) const = default;
};

/// All orders of a sheriff for a deputy. A command that is not listed is to be removed.
struct Orders {
  time::Timestamp stamp{};
  std::string deputy_id;
  std::string sheriff_id;
  std::vector<CommandOrder> commands;

  bool operator==(const Orders&) const = default;
};

/// The state of one command.
struct CommandStatus {
  CommandSpec spec;
  std::int32_t pid = 0;          ///< 0: not running
  std::int32_t actual_run = 0;   ///< number of the present or the last run
  std::int32_t wait_status = 0;  ///< of the last end, as from waitpid(); 0 while it runs
  float cpu_share = 0.0F;        ///< fraction of all processors, 0 to 1
  std::int64_t vsize_bytes = 0;
  std::int64_t rss_bytes = 0;

  bool operator==(const CommandStatus&) const = default;
};

/// The memory of a host.
struct Memory {
  std::int64_t total_bytes = 0;
  std::int64_t free_bytes = 0;
  std::int64_t swap_total_bytes = 0;
  std::int64_t swap_free_bytes = 0;

  bool operator==(const Memory&) const = default;
};

/// The state of a deputy and its host.
struct DeputyInfo {
  time::Timestamp stamp{};
  std::string deputy_id;
  float cpu_load = -1.0F;  ///< 0 to 1; negative before it is known
  Memory memory;
  std::vector<CommandStatus> commands;

  bool operator==(const DeputyInfo&) const = default;
};

/// The history of a running command, which only its deputy knows.
struct CommandRun {
  std::string command_id;
  std::int32_t pid = 0;
  time::Duration uptime{};
  std::int64_t num_restarts = 0;  ///< ordered or not, since the deputy first knew the command

  bool operator==(const CommandRun&) const = default;
};

struct Runs {
  time::Timestamp stamp{};
  std::string deputy_id;
  std::vector<CommandRun> runs;

  bool operator==(const Runs&) const = default;
};

struct Discovery {
  time::Timestamp stamp{};
  std::string transmitter_id;
  std::int64_t nonce = 0;  ///< unique for each deputy process; 0 from a sheriff

  bool operator==(const Discovery&) const = default;
};

/// Output of one command; with an empty id, output of the deputy itself.
struct CommandOutput {
  std::string command_id;
  std::string text;

  bool operator==(const CommandOutput&) const = default;
};

struct Output {
  time::Timestamp stamp{};
  std::string deputy_id;
  std::vector<CommandOutput> outputs;

  bool operator==(const Output&) const = default;
};

}  // namespace nodmap::procman
