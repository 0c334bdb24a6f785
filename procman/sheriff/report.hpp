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
  std::string end;  ///< how it ended, when it does not run
  std::int32_t pid = 0;
  double cpu_percent = 0.0;  ///< of the whole host
  double memory_mb = 0.0;
  double uptime_s = 0.0;  ///< as its deputy says, or as long as this sheriff has seen it
  std::int64_t restarts = 0;
  std::string health;  ///< of STATUS; empty where none came
  std::string last_output;
};

/// What is known now. `consoles` hold what the commands wrote.
[[nodiscard]] std::vector<ReportRow> report(const Fleet& fleet, const HealthWatch& health,
                                            const std::map<std::string, Console>& consoles,
                                            time::SteadyTime now);

/// As a table for people, a line for each command.
[[nodiscard]] std::vector<std::string> to_table(const std::vector<ReportRow>& rows);

/// For programs.
[[nodiscard]] nlohmann::json to_json(const std::vector<ReportRow>& rows, const Fleet& fleet,
                                     time::SteadyTime now);

/// Text that a terminal may be given: control characters and what is not UTF-8 become '?'.
[[nodiscard]] std::string printable(const std::string& text);

/// A number with so many digits after the point.
[[nodiscard]] std::string fixed(double value, int digits);

/// A time as people say it: 5s, 2m3s, 1h4m.
[[nodiscard]] std::string duration(double seconds);

}  // namespace nodmap::procman
