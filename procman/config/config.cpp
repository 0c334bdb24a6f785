// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/config.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "procman/config/exec_line.hpp"

namespace nodmap::procman {
namespace {

// The names of all scripts that a script runs, directly or through others; contains its own name
// only if it runs itself.
std::set<std::string> scripts_run_by(const Config& config, const Script& script) {
  std::set<std::string> run;
  std::vector<const Script*> pending{&script};
  while (!pending.empty()) {
    const Script* next = pending.back();
    pending.pop_back();
    for (const Action& action : next->actions) {
      const auto* call = std::get_if<RunScript>(&action.what);
      const Script* callee = call != nullptr ? config.find_script(call->name) : nullptr;
      if (callee != nullptr && run.insert(callee->name).second) {
        pending.push_back(callee);
      }
    }
  }
  return run;
}

std::string fault_of(const Config& config, const Target& target) {
  if (target.kind == TargetKind::kCommand && config.find_command(target.name) == nullptr) {
    return "there is no command \"" + target.name + "\"";
  }
  if (target.kind == TargetKind::kGroup && !config.has_group(target.name)) {
    return "there is no group \"" + target.name + "\"";
  }
  return {};
}

std::string fault_of(const Config& config, const Action& action) {
  if (const auto* order = std::get_if<Order>(&action.what)) {
    return fault_of(config, order->target);
  }
  if (const auto* wait = std::get_if<WaitFor>(&action.what)) {
    return fault_of(config, wait->target);
  }
  const auto* call = std::get_if<RunScript>(&action.what);
  if (call != nullptr && config.find_script(call->name) == nullptr) {
    return "there is no script \"" + call->name + "\"";
  }
  return {};
}

}  // namespace

const char* name_of(Verb verb) {
  return verb == Verb::kStart ? "start" : verb == Verb::kStop ? "stop" : "restart";
}

const Command* Config::find_command(std::string_view id) const {
  const auto found = std::ranges::find(commands, id, &Command::id);
  return found == commands.end() ? nullptr : &*found;
}

const Script* Config::find_script(std::string_view name) const {
  const auto found = std::ranges::find(scripts, name, &Script::name);
  return found == scripts.end() ? nullptr : &*found;
}

bool Config::has_group(std::string_view path) const {
  return std::ranges::find(groups, normalized_group(path)) != groups.end();
}

std::vector<const Command*> Config::commands_of(const Target& target) const {
  std::vector<const Command*> found;
  const std::string group = normalized_group(target.name);
  for (const Command& command : commands) {
    if (target.kind == TargetKind::kEverything ||
        (target.kind == TargetKind::kCommand && command.id == target.name) ||
        (target.kind == TargetKind::kGroup && is_in_group(command.group, group))) {
      found.push_back(&command);
    }
  }
  return found;
}

std::string normalized_group(std::string_view path) {
  std::string normalized;
  for (const char c : path) {
    if (c != '/' || (!normalized.empty() && normalized.back() != '/')) {
      normalized += c;
    }
  }
  if (!normalized.empty() && normalized.back() == '/') {
    normalized.pop_back();
  }
  return normalized;
}

bool is_in_group(std::string_view group, std::string_view ancestor) {
  return group == ancestor || (group.starts_with(ancestor) && group.size() > ancestor.size() &&
                               group[ancestor.size()] == '/');
}

std::string status_name(const Command& command) {
  return command.health.status_name.empty() ? program_of(command.exec) : command.health.status_name;
}

std::vector<ConfigError> check_scripts(const Config& config) {
  std::vector<ConfigError> errors;
  for (const Script& script : config.scripts) {
    for (const Action& action : script.actions) {
      if (std::string fault = fault_of(config, action); !fault.empty()) {
        errors.push_back({action.place, std::move(fault)});
      }
    }
    if (scripts_run_by(config, script).contains(script.name)) {
      errors.push_back({script.place, "the script \"" + script.name + "\" runs itself"});
    }
  }
  return errors;
}

}  // namespace nodmap::procman
