// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/report.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "procman/protocol/wait_status.hpp"
#include "procman/sheriff/printable.hpp"
#include "procman/sheriff/table.hpp"

namespace nodmap::procman {
namespace {

std::string path_cell(const ReportRow& row) {
  return printable(row.group.empty() ? row.id : row.group + "/" + row.id);
}

}  // namespace

std::string state_sentence(const ReportRow& row) {
  return name_of(row.state) + (row.end.empty() ? "" : ", " + row.end);
}

bool is_silent(const ReportRow& row) {
  return row.silent > node::kStatusSilence;
}

std::string health_word(const ReportRow& row) {
  return !row.health ? "" : is_silent(row) ? "SILENT" : name_of(row.health->state);
}

std::string health_sentence(const ReportRow& row) {
  if (!row.health) {
    return {};
  }
  if (is_silent(row)) {
    return fmt::format("SILENT: no STATUS for {} s", row.silent / 1s);
  }
  const ProcessHealth& health = *row.health;
  return printable(fmt::format(
      "{}{} ({:.0f}/s, p50 {:.0f} us, p99 {:.0f} us, lost {}, rejected {})", name_of(health.state),
      health.reason.empty() ? "" : ": " + health.reason, health.handled_per_s,
      health.latency_p50_us, health.latency_p99_us, health.lost, health.rejected));
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
    row.state = fleet.state_of(item, now);
    const Fleet::Run run = Fleet::run_of(item);
    row.restarts = run.num_restarts;
    if (item.status && row.state != CommandState::kUnknown) {
      row.pid = item.status->pid;
      row.end = row.pid == 0 ? describe_end(item.status->wait_status) : "";
      row.cpu_percent = 100.0 * static_cast<double>(item.status->cpu_share);
      row.memory_mb = static_cast<double>(item.status->rss_bytes) * 1e-6;
      row.uptime = row.pid != 0 ? now - run.started : 0s;
    }
    const auto status = health.last_status_of(row.id);
    // A STATUS of the process before does not count.
    if (row.pid != 0 && status && status->received >= item.running_since) {
      row.health = status->health;
      row.silent = now - status->received;
    }
    const auto console = consoles.find(row.id);
    row.last_output = console == consoles.end() ? "" : printable(console->second.last());
    rows.push_back(std::move(row));
  }
  std::ranges::stable_sort(rows, {}, &ReportRow::group);
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
  static constexpr Column kColumns[] = {
      {"COMMAND", Side::kLeft, path_cell},      {"HOST", Side::kLeft, host_cell},
      {"STATE", Side::kLeft, state_sentence},   {"PID", Side::kLeft, pid_cell},
      {"CPU %", Side::kLeft, cpu_cell},         {"MEM MB", Side::kLeft, memory_cell},
      {"UP", Side::kLeft, uptime_cell},         {"RESTARTS", Side::kLeft, restarts_cell},
      {"HEALTH", Side::kLeft, health_sentence}, {"LAST OUTPUT", Side::kLeft, output_cell},
  };
  std::vector<std::string> lines = aligned(kColumns, rows, "  ");
  for (std::string& line : lines) {
    line.erase(line.find_last_not_of(' ') + 1);
  }
  return lines;
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
                        {"uptime_s", time::seconds(row.uptime)},
                        {"restarts", row.restarts},
                        {"health", health_sentence(row)}});
  }
  nlohmann::json printable_warnings = nlohmann::json::array();
  std::ranges::transform(warnings, std::back_inserter(printable_warnings), printable);
  nlohmann::json hosts = nlohmann::json::array();
  for (const auto& [id, deputy] : fleet.deputies().all()) {
    nlohmann::json host{{"host", printable(id)},
                        {"reporting", fleet.deputies().is_reporting(id, now)}};
    if (deputy) {
      host["cpu_load"] = deputy->info.cpu_load;
      host["memory_total_mb"] = static_cast<double>(deputy->info.memory.total_bytes) * 1e-6;
      host["memory_free_mb"] = static_cast<double>(deputy->info.memory.free_bytes) * 1e-6;
    }
    hosts.push_back(std::move(host));
  }
  return {{"commands", std::move(commands)},
          {"hosts", std::move(hosts)},
          {"other_sheriff", printable(fleet.other_sheriffs().running(now).value_or(""))},
          {"warnings", std::move(printable_warnings)}};
}

}  // namespace nodmap::procman
