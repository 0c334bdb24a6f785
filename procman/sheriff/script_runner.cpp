// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/script_runner.hpp"

#include <algorithm>

namespace nodmap::procman {
namespace {

std::string describe(const Target& target) {
  switch (target.kind) {
    case TargetKind::kCommand:
      return "cmd \"" + target.name + "\"";
    case TargetKind::kGroup:
      return "group \"" + target.name + "\"";
    default:
      return "everything";
  }
}

const char* name_of(Wanted wanted) {
  return wanted == Wanted::kRunning ? "running" : "stopped";
}

}  // namespace

void give_order(Fleet& fleet, Verb verb, const std::string& id) {
  switch (verb) {
    case Verb::kStart:
      fleet.start(id);
      break;
    case Verb::kStop:
      fleet.stop(id);
      break;
    case Verb::kRestart:
      fleet.restart(id);
      break;
  }
}

void give_order(Fleet& fleet, const Config& config, Verb verb, const Target& target) {
  for (const Command* command : config.commands_of(target)) {
    give_order(fleet, verb, command->id);
  }
}

bool has_reached(const Fleet& fleet, const Config& config, const Target& target, Wanted wanted,
                 std::int64_t now_us) {
  const auto commands = config.commands_of(target);
  return std::all_of(commands.begin(), commands.end(), [&](const Command* command) {
    return fleet.has_reached(command->id, wanted, now_us);
  });
}

ScriptRunner::ScriptRunner(const Config& config, const Script& script) : config_(config) {
  append(script);
}

void ScriptRunner::append(const Script& script) {
  for (const Action& action : script.actions) {
    const auto* call = std::get_if<RunScript>(&action.what);
    const Script* callee = call != nullptr ? config_.find_script(call->name) : nullptr;
    if (callee != nullptr) {
      append(*callee);
    } else {
      actions_.push_back(&action);
    }
  }
}

void ScriptRunner::step(Fleet& fleet, std::int64_t now_us) {
  while (!done()) {
    if (!begun_) {
      begun_ = true;
      begun_us_ = now_us;
      if (const auto* order = std::get_if<Order>(&actions_[at_]->what)) {
        give_order(fleet, config_, order->verb, order->target);
      }
    }
    if (!is_over(fleet, now_us)) {
      return;
    }
    begun_ = false;
    ++at_;
  }
}

bool ScriptRunner::is_over(const Fleet& fleet, std::int64_t now_us) const {
  const Action& action = *actions_[at_];
  if (const auto* pause = std::get_if<WaitTime>(&action.what)) {
    return now_us - begun_us_ >= pause->duration_ms * 1000;
  }
  if (const auto* wait = std::get_if<WaitStatus>(&action.what)) {
    return procman::has_reached(fleet, config_, wait->target, wait->status, now_us);
  }
  const auto* order = std::get_if<Order>(&action.what);
  return order == nullptr || !order->wait ||
         procman::has_reached(fleet, config_, order->target, *order->wait, now_us);
}

std::string ScriptRunner::waiting_for() const {
  if (done()) {
    return "nothing";
  }
  const Action& action = *actions_[at_];
  if (const auto* wait = std::get_if<WaitStatus>(&action.what)) {
    return describe(wait->target) + " to be " + name_of(wait->status);
  }
  const auto* order = std::get_if<Order>(&action.what);
  if (order != nullptr && order->wait) {
    return describe(order->target) + " to be " + name_of(*order->wait);
  }
  return "a moment";
}

}  // namespace nodmap::procman
