// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
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
  double uptime_s = 0.0;  ///< as its deputy reports it; else as observed by this sheriff
  std::int64_t restarts = 0;
  std::string health;  ///< from STATUS; empty if none was received
  std::string last_output;
};

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

/// Makes text safe for a terminal: control characters and invalid UTF-8 become '?'.
[[nodiscard]] std::string printable(const std::string& text);

/// Formats a number with this many decimals.
[[nodiscard]] std::string fixed(double value, int digits);

/// Formats a duration: 5s, 2m3s, 1h4m.
[[nodiscard]] std::string duration(double seconds);

}  // namespace nodmap::procman
