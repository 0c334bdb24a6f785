// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/supervisor.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <set>
#include <string_view>
#include <utility>

namespace nodmap::procman {
namespace {

constexpr int kCannotRunStatus = 127 << 8;  // exit code 127, as in a shell
constexpr double kMaxGraceS = 24.0 * 3600.0;

constexpr double kMaxUntrustedGraceS = 60.0;

// Of a command in PM_INFO: its numbers, and the lengths and ends of its texts.
constexpr std::size_t kNumberBytes = 128;

std::size_t text_bytes(const CommandSpec& spec) {
  return spec.id.size() + spec.exec.size() + spec.group.size();
}

// Whether a process ends at this signal unless it handles it.
bool is_end(int signal) {
  return signal == SIGINT || signal == SIGTERM || signal == SIGHUP || signal == SIGQUIT ||
         signal == SIGKILL;
}

}  // namespace

SupervisorActions Supervisor::take_orders(const Orders& orders, time::Duration age,
                                          time::SteadyTime now) {
  SupervisorActions actions;
  if (is_shutting_down_ || orders.deputy_id != deputy_id_ ||
      orders.commands.size() > kMaxCommands) {
    return actions;
  }
  if (age > kMaxOrdersAge) {
    for (const CommandOrder& order : orders.commands) {
      actions.emplace_back(
          WriteOutput{order.spec.id, "ignoring stale orders (utime " + std::to_string(age / 1s) +
                                         " seconds ago). You may want to check the system "
                                         "clocks!\n"});
    }
    return actions;
  }
  std::set<std::string_view> ordered;
  for (const CommandOrder& order : orders.commands) {
    // A command that is listed again, in another run, would be started twice: it does not run yet.
    if (ordered.insert(order.spec.id).second) {
      obey(order, now, actions);
    }
  }
  if (trusts_orders_) {
    remove_missing(ordered, now, actions);
  }
  if (!actions.empty()) {
    actions.emplace_back(PublishInfo{});
  }
  return actions;
}

void Supervisor::obey(const CommandOrder& order, time::SteadyTime now, SupervisorActions& actions) {
  const bool is_new = !commands_.contains(order.spec.id);
  const bool has_room = has_room_for(order.spec);
  if (!has_room) {
    actions.emplace_back(
        RefuseOrder{"too_many_commands", "too many commands, or too long ones: some are refused"});
    if (is_new) {
      return;
    }
  }
  Entry& entry = commands_[order.spec.id];
  if ((has_room && update_spec(entry, order.spec)) || is_new) {
    actions.emplace_back(PublishInfo{});
  }
  entry.is_removed = false;
  entry.is_wanted = !order.force_quit;
  if (!entry.is_wanted) {
    entry.respawn_due.reset();
  }
  const bool runs = entry.pid != 0;
  if (!runs && entry.is_wanted && entry.actual_run != order.desired_run) {
    start(entry, order.desired_run, now, actions);
  } else if (runs && (!entry.is_wanted ||
                      (order.desired_run != entry.actual_run && order.desired_run != 0))) {
    stop(entry, now, actions);
  } else if (order.desired_run != 0) {
    entry.actual_run = order.desired_run;
  }
}

// Whether PM_INFO stays short enough with a new or changed description.
bool Supervisor::has_room_for(const CommandSpec& spec) const {
  const auto known = commands_.find(spec.id);
  const bool is_new = known == commands_.end();
  const std::size_t count = commands_.size() + (is_new ? 1 : 0);
  const std::size_t replaced = is_new ? 0 : text_bytes(known->second.spec);
  const std::size_t bytes = text_bytes_ - replaced + text_bytes(spec) + count * kNumberBytes;
  return count <= kMaxCommands && (bytes <= kMaxInfoBytes || text_bytes(spec) <= replaced);
}

std::map<std::string, Supervisor::Entry>::iterator Supervisor::forget(
    std::map<std::string, Entry>::iterator at) {
  text_bytes_ -= text_bytes(at->second.spec);
  return commands_.erase(at);
}

// Makes a description from the network safe: a valid signal and grace time.
CommandSpec Supervisor::checked(CommandSpec spec) const {
  const bool is_signal = spec.stop_signal >= 1 && spec.stop_signal <= SIGRTMAX;
  if (!(trusts_orders_ ? is_signal : is_end(spec.stop_signal))) {
    spec.stop_signal = SIGINT;
  }
  if (!(spec.stop_time_allowed_s >= 0.0)) {  // also for NaN
    spec.stop_time_allowed_s = 0.0;
  }
  spec.stop_time_allowed_s =
      std::min(spec.stop_time_allowed_s, trusts_orders_ ? kMaxGraceS : kMaxUntrustedGraceS);
  return spec;
}

// Adopts a new description; a running process continues unchanged. Returns whether anything
// visible has changed.
bool Supervisor::update_spec(Entry& entry, const CommandSpec& spec) {
  CommandSpec wanted = checked(spec);
  if (entry.spec == wanted) {
    return false;
  }
  text_bytes_ += text_bytes(wanted) - text_bytes(entry.spec);
  entry.spec = std::move(wanted);
  return true;
}

void Supervisor::remove_missing(const std::set<std::string_view>& ordered, time::SteadyTime now,
                                SupervisorActions& actions) {
  for (auto at = commands_.begin(); at != commands_.end();) {
    const bool is_ordered = ordered.contains(at->first);
    Entry& entry = at->second;
    if (is_ordered) {
      ++at;
    } else if (entry.pid != 0) {
      entry.is_removed = true;
      entry.is_wanted = false;
      stop(entry, now, actions);
      ++at;
    } else {
      actions.emplace_back(ForgetCommand{at->first});
      at = forget(at);
    }
  }
}

void Supervisor::start(Entry& entry, std::int32_t run, time::SteadyTime now,
                       SupervisorActions& actions) {
  entry.respawn_due.reset();
  entry.started = now;
  entry.actual_run = run;
  entry.wait_status = 0;
  entry.is_refused = false;
  entry.kill_due.reset();
  actions.emplace_back(StartCommand{entry.spec.id, entry.spec.exec});
}

void Supervisor::stop(Entry& entry, time::SteadyTime now, SupervisorActions& actions) {
  // A command that is being stopped does not respawn, until an order wants it again.
  entry.is_wanted = false;
  entry.respawn_due.reset();
  if (entry.kill_due) {
    return;  // it is already stopping, and poll() will kill it if necessary
  }
  entry.kill_due = now + time::from_seconds(entry.spec.stop_time_allowed_s);
  actions.emplace_back(SignalCommand{entry.spec.id, entry.spec.stop_signal});
}

void Supervisor::started(const std::string& id, std::int32_t pid, time::SteadyTime now) {
  Entry& entry = commands_.at(id);
  entry.pid = pid;
  entry.started = now;
  ++entry.num_starts;
}

SupervisorActions Supervisor::not_started(const std::string& id, const std::string& reason,
                                          time::SteadyTime now) {
  SupervisorActions actions{WriteOutput{id, reason + "\n"}};
  SupervisorActions end = ended(id, kCannotRunStatus, now);
  actions.insert(actions.end(), end.begin(), end.end());
  return actions;
}

SupervisorActions Supervisor::refused(const std::string& id, const std::string& reason,
                                      time::SteadyTime now) {
  commands_.at(id).is_refused = true;
  return not_started(id, reason, now);
}

void Supervisor::retry_refused(time::SteadyTime now) {
  for (auto& [id, entry] : commands_) {
    if (entry.is_refused && entry.is_wanted && entry.spec.auto_respawn) {
      entry.respawn_due = now;
    }
  }
}

SupervisorActions Supervisor::ended(const std::string& id, int wait_status, time::SteadyTime now) {
  SupervisorActions actions;
  Entry& entry = commands_.at(id);
  entry.pid = 0;
  entry.wait_status = wait_status;
  entry.kill_due.reset();
  if (WIFSIGNALED(wait_status)) {
    const char* name = ::sigdescr_np(WTERMSIG(wait_status));
    const std::string unknown = "Signal " + std::to_string(WTERMSIG(wait_status));
    actions.emplace_back(WriteOutput{id, (name != nullptr ? std::string(name) : unknown) + "\n"});
    if (WCOREDUMP(wait_status)) {
      actions.emplace_back(WriteOutput{id, "Core dumped.\n"});
    }
  }
  if (entry.is_removed) {
    actions.emplace_back(ForgetCommand{id});
    forget(commands_.find(id));
  } else if (entry.spec.auto_respawn && entry.is_wanted && !entry.is_refused &&
             !is_shutting_down_) {
    schedule_respawn(entry, now);
  }
  actions.emplace_back(PublishInfo{});
  return actions;
}

// The delay doubles for a command that lives for less than a second; each second of life undoes
// one doubling.
void Supervisor::schedule_respawn(Entry& entry, time::SteadyTime now) {
  const time::Duration lived = now - entry.started;
  const auto halvings = std::clamp<std::int64_t>(lived / kMaxRespawnDelay, 0, 30);
  entry.respawn_delay = std::max(kMinRespawnDelay, entry.respawn_delay / (1 << halvings));
  entry.respawn_due = now + entry.respawn_delay;
  if (halvings == 0) {
    entry.respawn_delay = std::min(kMaxRespawnDelay, 2 * entry.respawn_delay);
  }
}

SupervisorActions Supervisor::poll(time::SteadyTime now) {
  SupervisorActions actions;
  for (auto& [id, entry] : commands_) {
    if (entry.kill_due && *entry.kill_due <= now) {
      entry.kill_due = now + kKillPeriod;
      actions.emplace_back(SignalCommand{id, SIGKILL});
    }
    if (entry.respawn_due && *entry.respawn_due <= now) {
      start(entry, entry.actual_run, now, actions);
      actions.emplace_back(PublishInfo{});
    }
  }
  return actions;
}

std::optional<time::SteadyTime> Supervisor::next_due() const {
  std::optional<time::SteadyTime> next;
  for (const auto& [id, entry] : commands_) {
    for (const std::optional<time::SteadyTime>& due : {entry.kill_due, entry.respawn_due}) {
      if (due && (!next || *due < *next)) {
        next = due;
      }
    }
  }
  return next;
}

SupervisorActions Supervisor::shut_down(time::SteadyTime now) {
  SupervisorActions actions;
  for (auto& [id, entry] : commands_) {
    entry.is_wanted = false;
    entry.respawn_due.reset();
    if (entry.pid == 0) {
      continue;
    }
    stop(entry, now, actions);
    if (is_shutting_down_) {
      entry.kill_due = now;
    }
  }
  is_shutting_down_ = true;
  return actions;
}

bool Supervisor::is_idle() const {
  return std::ranges::all_of(commands_, [](const auto& item) { return item.second.pid == 0; });
}

std::vector<CommandStatus> Supervisor::statuses() const {
  std::vector<CommandStatus> all;
  all.reserve(commands_.size());
  for (const auto& [id, entry] : commands_) {
    CommandStatus status;
    status.spec = entry.spec;
    status.pid = entry.pid;
    status.actual_run = entry.actual_run;
    status.wait_status = entry.wait_status;
    all.push_back(std::move(status));
  }
  return all;
}

std::vector<CommandRun> Supervisor::runs(time::SteadyTime now) const {
  std::vector<CommandRun> runs;
  for (const auto& [id, entry] : commands_) {
    if (entry.pid != 0) {
      runs.push_back({id, entry.pid, now - entry.started, entry.num_starts - 1});
    }
  }
  return runs;
}

}  // namespace nodmap::procman
