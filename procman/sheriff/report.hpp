// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/protocol/console.hpp"
#include "procman/protocol/fleet.hpp"
#include "procman/sheriff/health_watch.hpp"

namespace nodmap::procman {

/// One command as a line of a table.
struct ReportRow {
  std::string id;
  std::string group;
  std::string deputy;
  CommandState state = CommandState::kUnknown;
  std::string end;  ///< how it ended, if it is not running
  std::int32_t pid = 0;
  double cpu_percent = 0.0;  ///< of the whole host
  double memory_mb = 0.0;
  time::Duration uptime{};  ///< as its deputy reports it; else as observed by this sheriff
  std::int64_t restarts = 0;
  std::optional<ProcessHealth> health;  ///< from the STATUS of the running process, if any
  time::Duration silent{};              ///< how long ago that was received
  std::string last_output;
};

/// The state, and how the command has ended: "Stopped (Error), exit 3".
[[nodiscard]] std::string state_sentence(const ReportRow& row);

/// Whether the running process has stopped sending STATUS.
[[nodiscard]] bool is_silent(const ReportRow& row);
/// OK, DEGRADED, FAILED or SILENT; empty if no STATUS was received.
[[nodiscard]] std::string health_word(const ReportRow& row);
/// The same with its reason, message rate, latencies and losses.
[[nodiscard]] std::string health_sentence(const ReportRow& row);

/// The present state of all commands. `consoles`: their output.
[[nodiscard]] std::vector<ReportRow> report(const Fleet& fleet, const HealthWatch& health,
                                            const std::map<std::string, Console>& consoles,
                                            time::SteadyTime now);

/// A sentence for each process that reports in the name of another, and is not believed.
[[nodiscard]] std::vector<std::string> warnings(const Fleet& fleet, const HealthWatch& health,
                                                time::SteadyTime now);

/// Formats a table for people, one line per command.
[[nodiscard]] std::vector<std::string> to_table(const std::vector<ReportRow>& rows);

/// Formats JSON for programs.
[[nodiscard]] nlohmann::json to_json(const std::vector<ReportRow>& rows,
                                     const std::vector<std::string>& warnings, const Fleet& fleet,
                                     time::SteadyTime now);

}  // namespace nodmap::procman
