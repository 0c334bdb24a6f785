// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/script_runner.hpp"

#include <algorithm>
#include <utility>

#include "procman/protocol/wait_status.hpp"

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
  return wanted == Wanted::kRunning   ? "running"
         : wanted == Wanted::kStopped ? "stopped"
                                      : "healthy";
}

// The status that an action waits for, if any.
std::optional<WaitFor> wait_of(const Action& action) {
  if (const auto* wait = std::get_if<WaitFor>(&action.what)) {
    return *wait;
  }
  const auto* order = std::get_if<Order>(&action.what);
  return order != nullptr && order->wait ? std::optional(WaitFor{order->target, *order->wait})
                                         : std::nullopt;
}

std::string describe_failure(const Fleet::Item& item) {
  const std::string end = describe_end(item.failed_status.value_or(0));
  return item.spec.id + (item.spec.auto_respawn ? " does not keep running" : " has ended") +
         (end.empty() ? "" : " (" + end + ")");
}

}  // namespace

void give_order(Fleet& fleet, const Config& config, Verb verb, const Target& target) {
  for (const Command* command : config.commands_of(target)) {
    fleet.order(verb, command->id);
  }
}

ScriptRunner::ScriptRunner(const Config& config, const Script& script, HealthTest is_healthy)
    : config_(config), is_healthy_(std::move(is_healthy)) {
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

void ScriptRunner::step(Fleet& fleet, time::SteadyTime now) {
  while (!is_over() && at_ < actions_.size()) {
    const Action& action = *actions_[at_];
    if (!has_begun_) {
      has_begun_ = true;
      begin_ = now;
      if (const auto* order = std::get_if<Order>(&action.what)) {
        give_order(fleet, config_, order->verb, order->target);
        note_order(*order);
      }
    }
    if (!try_to_finish(action, fleet, now)) {
      return;
    }
    has_begun_ = false;
    ++at_;
  }
  if (!is_over()) {
    settle(fleet, now);
  }
}

void ScriptRunner::note_order(const Order& order) {
  for (const Command* command : config_.commands_of(order.target)) {
    if (order.verb == Verb::kStop) {
      started_.erase(command->id);
    } else {
      started_.insert(command->id);
    }
  }
}

// Returns whether an action is done; sets `failure_` if it cannot be done any more.
bool ScriptRunner::try_to_finish(const Action& action, const Fleet& fleet, time::SteadyTime now) {
  if (const auto* pause = std::get_if<Pause>(&action.what)) {
    return now - begin_ >= std::chrono::milliseconds(pause->duration_ms);
  }
  const std::optional<WaitFor> wait = wait_of(action);
  if (!wait) {
    return true;
  }
  if (wait->status != Wanted::kStopped) {
    failure_ = dead_commands(wait->target, fleet, now);
  }
  return has_arrived(*wait, fleet, now);
}

bool ScriptRunner::has_arrived(const WaitFor& wait, const Fleet& fleet,
                               time::SteadyTime now) const {
  return std::ranges::all_of(config_.commands_of(wait.target), [&](const Command* command) {
    switch (wait.status) {
      case Wanted::kStopped:
        return fleet.is_stopped(command->id, now);
      case Wanted::kRunning:
        return fleet.is_running(command->id, now);
      default:
        return fleet.is_running(command->id, now) && is_healthy_(command->id);
    }
  });
}

// The commands that have ended with an error and are not respawned, and how they ended.
std::string ScriptRunner::dead_commands(const Target& target, const Fleet& fleet,
                                        time::SteadyTime now) const {
  std::string dead;
  for (const Command* command : config_.commands_of(target)) {
    if (fleet.state_of(command->id, now) == CommandState::kStoppedError && !command->auto_respawn) {
      dead += (dead.empty() ? "" : ", ") + describe_failure(*fleet.find(command->id));
    }
  }
  return dead;
}

namespace {

// Why a started command that has not lasted is not settled either; empty if nothing is wrong yet.
std::string failure_of(const std::string& id, const Fleet::Item& item, CommandState state) {
  if (state == CommandState::kUnknown || state == CommandState::kStarting) {
    return id + " has not been started";
  }
  return item.failed_status ? describe_failure(item) : "";
}

}  // namespace

// After the last action: checks that all started commands keep running or have ended without
// error.
void ScriptRunner::settle(const Fleet& fleet, time::SteadyTime now) {
  done_ = done_.value_or(now);
  std::string failed;
  bool is_clear = true;
  for (const std::string& id : started_) {
    const Fleet::Item& item = *fleet.find(id);
    const CommandState state = fleet.state_of(id, now);
    const bool has_lasted =
        state == CommandState::kRunning && now - item.running_since >= kLastingTime;
    const bool is_dead = state == CommandState::kStoppedError && !item.spec.auto_respawn;
    is_clear = is_clear && (has_lasted || is_dead || state == CommandState::kStoppedOk);
    const std::string failure = has_lasted ? "" : failure_of(id, item, state);
    if (!failure.empty()) {
      failed += (failed.empty() ? "" : ", ") + failure;
    }
  }
  if (is_clear || now - *done_ >= kSettleTimeout) {
    is_settled_ = true;
    failure_ = failed;
  }
}

std::string ScriptRunner::waiting_for() const {
  if (is_over()) {
    return "nothing";
  }
  if (at_ == actions_.size()) {
    return "the started commands to keep running";
  }
  const std::optional<WaitFor> wait = wait_of(*actions_[at_]);
  return wait ? describe(wait->target) + " to be " + name_of(wait->status) : "a moment";
}

}  // namespace nodmap::procman
