// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "procman/protocol/wait_status.hpp"

namespace nodmap::procman {
namespace {

std::string health_text(const ProcessHealth& health) {
  std::string text = name_of(health.state);
  if (!health.reason.empty()) {
    text += ": " + health.reason;
  }
  return text + " (" + fixed(health.handled_per_s, 0) + "/s, p50 " +
         fixed(health.latency_p50_us, 0) + " us, p99 " + fixed(health.latency_p99_us, 0) +
         " us, lost " + std::to_string(health.lost) + ", rejected " +
         std::to_string(health.rejected) + ")";
}

/// The health of the running process; a STATUS of its predecessor does not count.
std::string health_cell(const std::optional<HealthWatch::LastStatus>& status,
                        const Fleet::Item& item, time::SteadyTime now) {
  if (!status || status->received < item.running_since) {
    return {};
  }
  const time::Duration silent = now - status->received;
  return silent > HealthWatch::kStatusSilence
             ? "SILENT: no STATUS for " + std::to_string(silent / 1s) + " s"
             : printable(health_text(status->health));
}

/// Length of the UTF-8 sequence that begins with this byte; 0 if none does.
std::size_t sequence_length(unsigned char first) {
  if (first < 0x80) {
    return 1;
  }
  return first >> 5U == 6 ? 2 : first >> 4U == 14 ? 3 : first >> 3U == 30 ? 4 : 0;
}

/// Length in bytes of the character at the start of `text`; 0 if it must not be sent to a terminal.
std::size_t good_character(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = sequence_length(byte(0));
  if (length > text.size() || byte(0) < 0x20 || byte(0) == 0x7F) {
    return 0;
  }
  constexpr std::array<unsigned, 5> kFirstBits{0, 0x7F, 0x1F, 0x0F, 0x07};
  constexpr std::array<unsigned, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  unsigned code_point = length == 0 ? 0 : byte(0) & kFirstBits[length];
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) {
      return 0;
    }
    code_point = code_point << 6U | (byte(i) & 0x3FU);
  }
  const bool is_overlong = code_point < kLeast[length];
  const bool is_none = (code_point >= 0xD800 && code_point < 0xE000) || code_point > 0x10FFFF;
  const bool steers = code_point >= 0x80 && code_point < 0xA0;  // these control terminals, too
  return is_overlong || is_none || steers ? 0 : length;
}

constexpr std::size_t kReportColumns = 10;
using Line = std::array<std::string, kReportColumns>;

Line cells(const ReportRow& row) {
  const bool runs = row.pid != 0;
  std::string state = name_of(row.state);
  if (!row.end.empty()) {
    state += ", " + row.end;
  }
  return {printable(row.group.empty() ? row.id : row.group + "/" + row.id),
          printable(row.deputy),
          std::move(state),
          runs ? std::to_string(row.pid) : "",
          runs ? fixed(row.cpu_percent, 1) : "",
          runs ? fixed(row.memory_mb, 1) : "",
          runs && row.uptime_s > 0.0 ? duration(row.uptime_s) : "",
          row.restarts > 0 ? std::to_string(row.restarts) : "",
          runs ? row.health : "",
          row.last_output};
}

}  // namespace

std::string fixed(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string duration(double seconds) {
  const auto total = static_cast<std::int64_t>(seconds);
  if (total < 60) {
    return std::to_string(total) + "s";
  }
  if (total < 3600) {
    return std::to_string(total / 60) + "m" + std::to_string(total % 60) + "s";
  }
  return std::to_string(total / 3600) + "h" + std::to_string(total % 3600 / 60) + "m";
}

std::string printable(const std::string& text) {
  std::string clean;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t length = good_character(std::string_view(text).substr(at));
    clean += length != 0 ? text.substr(at, length) : "?";
    at += std::max<std::size_t>(1, length);
  }
  return clean;
}

std::vector<ReportRow> report(const Fleet& fleet, const HealthWatch& health,
                              const std::map<std::string, Console>& consoles,
                              time::SteadyTime now) {
  std::vector<ReportRow> rows;
  for (const Fleet::Item& item : fleet.items()) {
    ReportRow row;
    row.id = item.spec.id;
    row.group = item.spec.group;
    row.deputy = item.deputy;
    row.state = fleet.state_of(row.id, now);
    const Fleet::Run run = Fleet::run_of(item);
    row.restarts = run.num_restarts;
    if (item.status && row.state != CommandState::kUnknown) {
      row.pid = item.status->pid;
      row.end = row.pid == 0 ? describe_end(item.status->wait_status) : "";
      row.cpu_percent = 100.0 * static_cast<double>(item.status->cpu_share);
      row.memory_mb = static_cast<double>(item.status->rss_bytes) * 1e-6;
      row.uptime_s = row.pid != 0 ? time::seconds(now - run.started) : 0;
    }
    row.health = row.pid != 0 ? health_cell(health.last_status_of(row.id), item, now) : "";
    const auto console = consoles.find(row.id);
    row.last_output = console == consoles.end() ? "" : printable(console->second.last());
    rows.push_back(std::move(row));
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const ReportRow& a, const ReportRow& b) { return a.group < b.group; });
  return rows;
}

std::vector<std::string> warnings(const Fleet& fleet, const HealthWatch& health,
                                  time::SteadyTime now) {
  std::vector<std::string> all;
  for (const std::string& deputy : fleet.deputies().contested(now)) {
    all.push_back("another process reports as the deputy " + deputy + ": it is not believed");
  }
  for (const std::string& name : health.contested_names(now)) {
    all.push_back("another process sends STATUS as " + name + ": it is not believed");
  }
  return all;
}

std::vector<std::string> to_table(const std::vector<ReportRow>& rows) {
  std::vector<Line> lines{{"COMMAND", "HOST", "STATE", "PID", "CPU %", "MEM MB", "UP", "RESTARTS",
                           "HEALTH", "LAST OUTPUT"}};
  std::transform(rows.begin(), rows.end(), std::back_inserter(lines), cells);
  std::array<std::size_t, kReportColumns> widths{};
  for (const Line& line : lines) {
    for (std::size_t i = 0; i < kReportColumns; ++i) {
      widths.at(i) = std::max(widths.at(i), line.at(i).size());
    }
  }
  std::vector<std::string> table;
  for (const Line& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < kReportColumns; ++i) {
      text += line.at(i) + std::string(widths.at(i) - line.at(i).size() + 2, ' ');
    }
    text.erase(text.find_last_not_of(' ') + 1);
    table.push_back(std::move(text));
  }
  return table;
}

nlohmann::json to_json(const std::vector<ReportRow>& rows, const std::vector<std::string>& warnings,
                       const Fleet& fleet, time::SteadyTime now) {
  nlohmann::json commands = nlohmann::json::array();
  for (const ReportRow& row : rows) {
    commands.push_back({{"command", printable(row.id)},
                        {"group", printable(row.group)},
                        {"host", printable(row.deputy)},
                        {"state", name_of(row.state)},
                        {"end", row.end},
                        {"pid", row.pid},
                        {"cpu_percent", row.cpu_percent},
                        {"memory_mb", row.memory_mb},
                        {"uptime_s", row.uptime_s},
                        {"restarts", row.restarts},
                        {"health", row.health}});
  }
  nlohmann::json printable_warnings = nlohmann::json::array();
  std::ranges::transform(warnings, std::back_inserter(printable_warnings), printable);
  nlohmann::json hosts = nlohmann::json::array();
  for (const auto& [id, deputy] : fleet.deputies().all()) {
    nlohmann::json host{{"host", printable(id)},
                        {"reporting", fleet.deputies().is_reporting(id, now)}};
    if (deputy) {
      host["cpu_load"] = deputy->info.cpu_load;
      host["memory_total_mb"] = static_cast<double>(deputy->info.memory_total_bytes) * 1e-6;
      host["memory_free_mb"] = static_cast<double>(deputy->info.memory_free_bytes) * 1e-6;
    }
    hosts.push_back(std::move(host));
  }
  return {{"commands", std::move(commands)},
          {"hosts", std::move(hosts)},
          {"other_sheriff", printable(fleet.other_sheriffs().running(now).value_or(""))},
          {"warnings", std::move(printable_warnings)}};
}

}  // namespace nodmap::procman
