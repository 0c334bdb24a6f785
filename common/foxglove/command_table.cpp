// SPDX-License-Identifier: BSD-3-Clause
#include "common/foxglove/command_table.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

namespace nodmap::foxglove {
namespace {

/// How a command ended that was not told to; empty for a good end.
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
          {"process_name", program_of(status.cmd.exec_str)},
          {"state", status.pid != 0 ? "running"
                    : end.empty()   ? "stopped"
                                    : "failed"},
          {"pid", status.pid},
          {"cpu_share", share_json(status.cpu_usage)},
          {"rss_bytes", status.mem_rss_bytes},
          {"end", end}};
}

procman_lcm::cmd_status_t never_run(const CommandTable::Known& known) {
  procman_lcm::cmd_status_t status{};
  status.cmd.command_id = known.command;
  status.cmd.group = known.group;
  status.cmd.exec_str = known.exec;
  return status;
}

}  // namespace

std::string program_of(const std::string& exec) {
  std::istringstream words(exec);
  std::string word;
  while (words >> word && word.find('=') != std::string::npos) {
  }
  return word.substr(word.rfind('/') + 1);
}

bool CommandTable::update(const procman_lcm::deputy_info_t& info) {
  const bool is_known = hosts_.contains(info.deputy_id);
  if ((!is_known && hosts_.size() >= kMaxHosts) || info.cmds.size() > kMaxCommands) {
    return false;
  }
  hosts_[info.deputy_id] = info;
  return true;
}

Json CommandTable::commands() const {
  std::int64_t newest_us = 0;
  Json hosts = Json::array();
  Json commands = Json::array();
  std::set<std::pair<std::string, std::string>> told;
  for (const auto& [host, info] : hosts_) {
    newest_us = std::max(newest_us, info.utime);
    hosts.push_back(host_json(info));
    for (const procman_lcm::cmd_status_t& status : info.cmds) {
      told.emplace(host, status.cmd.command_id);
      commands.push_back(command_json(host, status));
    }
  }
  for (const Known& known : known_) {
    if (!told.contains({known.host, known.command})) {
      commands.push_back(command_json(known.host, never_run(known)));
    }
  }
  std::sort(commands.begin(), commands.end(), [](const Json& a, const Json& b) {
    return std::tie(a["group"], a["command"]) < std::tie(b["group"], b["command"]);
  });
  return {{"timestamp", time_json(newest_us)},
          {"hosts", std::move(hosts)},
          {"commands", std::move(commands)}};
}

}  // namespace nodmap::foxglove
