// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/check.hpp"

#include <set>
#include <string>
#include <utility>

namespace nodmap::procman {
namespace {

/// The scripts that a script runs, by itself or through others, without the script's own name
/// unless it comes back to it.
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
  if (const auto* wait = std::get_if<WaitStatus>(&action.what)) {
    return fault_of(config, wait->target);
  }
  const auto* call = std::get_if<RunScript>(&action.what);
  if (call != nullptr && config.find_script(call->name) == nullptr) {
    return "there is no script \"" + call->name + "\"";
  }
  return {};
}

}  // namespace

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
