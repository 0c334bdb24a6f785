// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::procman {

/// The channels of the protocol.
inline constexpr const char* kDiscoverChannel = "PM_DISCOVER";
inline constexpr const char* kInfoChannel = "PM_INFO";
inline constexpr const char* kOrdersChannel = "PM_ORDERS";
inline constexpr const char* kOutputChannel = "PM_OUTPUT";
/// Ours: the existing tools do not know it.
inline constexpr const char* kRunsChannel = "PM_RUNS";

/// A command as sheriff and deputy speak of it.
struct CommandSpec {
  std::string id;
  std::string exec;
  std::string group;
  bool auto_respawn = false;
  int stop_signal = 2;
  double stop_time_allowed_s = 7.0;

  bool operator==(const CommandSpec&) const = default;
};

/// What is wanted of one command.
struct CommandOrder {
  CommandSpec spec;
  std::int32_t desired_run = 0;
  bool force_quit = false;

  bool operator==(const CommandOrder&) const = default;
};

/// All that a sheriff wants of a deputy: a command that is not here is to go.
struct Orders {
  time::Timestamp stamp{};
  std::string deputy_id;
  std::string sheriff_id;
  std::vector<CommandOrder> commands;

  bool operator==(const Orders&) const = default;
};

/// How one command is.
struct CommandStatus {
  CommandSpec spec;
  std::int32_t pid = 0;          ///< 0: it does not run
  std::int32_t actual_run = 0;   ///< that runs, or ran last
  std::int32_t wait_status = 0;  ///< raw, of the last end; 0 while it runs
  float cpu_share = 0.0F;        ///< of all processors, 0 to 1
  std::int64_t vsize_bytes = 0;
  std::int64_t rss_bytes = 0;

  bool operator==(const CommandStatus&) const = default;
};

/// How a deputy and its host are.
struct DeputyInfo {
  time::Timestamp stamp{};
  std::string deputy_id;
  float cpu_load = -1.0F;  ///< 0 to 1; negative before it is known
  std::int64_t memory_total_bytes = 0;
  std::int64_t memory_free_bytes = 0;
  std::int64_t swap_total_bytes = 0;
  std::int64_t swap_free_bytes = 0;
  std::vector<CommandStatus> commands;

  bool operator==(const DeputyInfo&) const = default;
};

/// How a command that runs came to run: only its deputy knows.
struct CommandRun {
  std::string command_id;
  std::int32_t pid = 0;
  time::Duration uptime{};
  std::int64_t num_restarts = 0;  ///< ordered or not, since its deputy knows the command

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
  std::int64_t nonce = 0;  ///< a deputy's process id; 0 from a sheriff

  bool operator==(const Discovery&) const = default;
};

/// What one command wrote; with an empty id what the deputy itself has to say.
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
