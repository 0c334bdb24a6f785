// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/process_tables.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "common/node/status.hpp"
#include "nodmap/json_messages.hpp"
#include "procman/config/exec_line.hpp"

namespace nodmap::foxglove {
namespace {

// Foxglove's LogLevel.
constexpr int kInfo = 2;
constexpr int kWarning = 3;
constexpr int kError = 4;

// Describes how a command ended if that was not ordered; empty for a clean end.
std::string end_of(const procman_lcm::cmd_status_t& status) {
  const int wait_status = status.exit_code;
  if (status.pid != 0 || wait_status == 0) {
    return {};
  }
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    return signal == status.cmd.stop_signal ? "" : "killed by signal " + std::to_string(signal);
  }
  return "exit " + std::to_string(WEXITSTATUS(wait_status));
}

Json share_json(float share) {
  return share >= 0.0F ? Json(share) : Json();
}

Json host_json(const procman_lcm::deputy_info_t& info) {
  return {{"host", info.deputy_id},
          {"cpu_share", share_json(info.cpu_load)},
          {"memory_total_bytes", info.phys_mem_total_bytes},
          {"memory_free_bytes", info.phys_mem_free_bytes}};
}

Json command_json(const std::string& host, const procman_lcm::cmd_status_t& status) {
  const std::string end = end_of(status);
  return {{"command", status.cmd.command_id},
          {"group", status.cmd.group},
          {"host", host},
          {"process_name", procman::program_of(status.cmd.exec_str)},
          {"state", status.pid != 0 ? "running"
                    : end.empty()   ? "stopped"
                                    : "failed"},
          {"pid", status.pid},
          {"cpu_share", share_json(status.cpu_usage)},
          {"rss_bytes", status.mem_rss_bytes},
          {"end", end}};
}

procman_lcm::cmd_status_t never_run(const procman::Command& command) {
  procman_lcm::cmd_status_t status{};
  status.cmd.command_id = command.id;
  status.cmd.group = command.group;
  status.cmd.exec_str = command.exec;
  return status;
}

}  // namespace

ProcessTable::Change ProcessTable::update(const nodmap::status_t& status,
                                          time::Timestamp received) {
  const auto found = processes_.find(status.process_name);
  if (found == processes_.end()) {
    if (processes_.size() >= kMaxProcesses) {
      return {};
    }
    processes_.emplace(status.process_name, Entry{status, received});
    return {.taken = true, .health_changed = true};
  }
  const nodmap::status_t& before = found->second.status;
  const bool changed =
      before.health != status.health || before.health_reason != status.health_reason;
  found->second = {status, received};
  return {.taken = true, .health_changed = changed};
}

Json ProcessTable::processes() const {
  time::Timestamp newest{};
  time::Timestamp last_received{};
  for (const auto& [name, entry] : processes_) {
    newest = std::max(newest, time::from_utime(entry.status.utime));
    last_received = std::max(last_received, entry.received);
  }
  Json list = Json::array();
  for (const auto& [name, entry] : processes_) {
    list.push_back(JsonMessage<nodmap::status_t>::fields(entry.status));
    list.back()["age_s"] = time::seconds(last_received - entry.received);
  }
  return {{"timestamp", time_json(newest)}, {"processes", std::move(list)}};
}

Json health_log(const nodmap::status_t& status) {
  const bool ok = status.health == nodmap::status_t::OK;
  const bool degraded = status.health == nodmap::status_t::DEGRADED;
  const std::string state = JsonMessage<nodmap::status_t>::constant_name(status.health);
  return {{"timestamp", time_json(time::from_utime(status.utime))},
          {"level", ok         ? kInfo
                    : degraded ? kWarning
                               : kError},
          {"message", status.health_reason.empty() ? state : state + ": " + status.health_reason},
          {"name", status.process_name},
          {"file", ""},
          {"line", 0}};
}

bool CommandTable::update(const procman_lcm::deputy_info_t& info, time::Timestamp received) {
  const bool is_known = hosts_.contains(info.deputy_id);
  if ((!is_known && hosts_.size() >= kMaxHosts) || info.cmds.size() > kMaxCommands) {
    return false;
  }
  hosts_[info.deputy_id] = {info, received};
  advance(received);
  return true;
}

bool CommandTable::advance(time::Timestamp received) {
  now_ = received;  // also back, as after the clock was set
  const std::ptrdiff_t before = silent_hosts_;
  silent_hosts_ =
      std::ranges::count_if(hosts_, [this](const auto& host) { return is_silent(host.second); });
  return silent_hosts_ > before;
}

bool CommandTable::is_silent(const Host& host) const {
  return now_ - host.received >= node::kStatusSilence;
}

Json CommandTable::commands() const {
  time::Timestamp newest{};
  Json hosts = Json::array();
  Json commands = Json::array();
  std::set<std::pair<std::string, std::string>> told;
  for (const auto& [name, host] : hosts_) {
    newest = std::max(newest, time::from_utime(host.info.utime));
    hosts.push_back(host_json(host.info));
    hosts.back()["age_s"] = time::seconds(now_ - host.received);
    for (const procman_lcm::cmd_status_t& status : host.info.cmds) {
      told.emplace(name, status.cmd.command_id);
      commands.push_back(command_json(name, status));
      if (is_silent(host)) {
        commands.back()["state"] = "no deputy";
      }
    }
  }
  for (const procman::Command& command : configured_) {
    if (!told.contains({command.deputy, command.id})) {
      commands.push_back(command_json(command.deputy, never_run(command)));
      const auto host = hosts_.find(command.deputy);
      if (host == hosts_.end() || is_silent(host->second)) {
        commands.back()["state"] = "no deputy";
      }
    }
  }
  std::sort(commands.begin(), commands.end(), [](const Json& a, const Json& b) {
    return std::tie(a["group"], a["command"]) < std::tie(b["group"], b["command"]);
  });
  return {{"timestamp", time_json(newest)},
          {"hosts", std::move(hosts)},
          {"commands", std::move(commands)}};
}

}  // namespace nodmap::foxglove
