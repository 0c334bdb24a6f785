// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/fleet.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <limits>
#include <utility>

#include "procman/protocol/host.hpp"
#include "procman/protocol/wait_status.hpp"

namespace nodmap::procman {
namespace {

CommandSpec spec_of(const Command& command) {
  return {.id = command.id,
          .exec = command.exec,
          .group = command.group,
          .auto_respawn = command.auto_respawn,
          .stop_signal = command.stop_signal,
          .stop_time_allowed_s = static_cast<double>(command.stop_time_allowed_s)};
}

// Far more than any robot has. Any sender on the network can name any number of commands.
constexpr std::size_t kMaxItems = 10'000;

// The number of the next run. Must not overflow, because a deputy may report any number.
std::int32_t run_after(std::int32_t run) {
  return run == std::numeric_limits<std::int32_t>::max() ? 1 : run + 1;
}

// Whether a command ended without error: with exit code 0, or by the signal sent to stop it.
bool is_good_end(const Fleet::Item& item) {
  const int status = item.status->wait_status;
  return status == 0 || (item.is_stop_ordered && may_be_a_stop(status, item.spec.stop_signal));
}

// Whether a deputy will start a command again that it reports as not running, as far as that can
// be seen: it has ended with an error, and not as one that was stopped.
bool will_respawn(const CommandStatus& status) {
  return status.pid == 0 && status.actual_run != 0 && status.spec.auto_respawn &&
         !may_be_a_stop(status.wait_status, status.spec.stop_signal);
}

// The item of a command, const if the items are; null if there is none.
auto* find_in(auto& items, const std::string& id) {
  const auto found =
      std::ranges::find_if(items, [&id](const Fleet::Item& item) { return item.spec.id == id; });
  return found == items.end() ? nullptr : &*found;
}

// The item of a command on a certain host: one that was moved to another host in the configuration
// has two.
auto* find_in(auto& items, const std::string& id, const std::string& deputy) {
  const auto found = std::ranges::find_if(
      items, [&](const Fleet::Item& item) { return item.spec.id == id && item.deputy == deputy; });
  return found == items.end() ? nullptr : &*found;
}

bool has_process(const Fleet::Item& item) {
  return item.status && item.status->pid != 0;
}

// Whether a deputy reports a command.
bool lists(const DeputyInfo& info, const std::string& id) {
  return std::ranges::any_of(info.commands,
                             [&id](const CommandStatus& status) { return status.spec.id == id; });
}

CommandState state_of_running(const Fleet::Item& item) {
  if (item.force_quit) {
    return CommandState::kStopping;
  }
  const bool is_this_run = item.desired_run == 0 || item.status->actual_run == item.desired_run;
  return is_this_run ? CommandState::kRunning : CommandState::kRestarting;
}

// When a sheriff started, from its id. Our ids and those of the existing sheriff have the form
// host:process:microseconds; for others the result is the epoch.
time::Timestamp beginning_of(const std::string& sheriff_id) {
  const std::size_t colon = sheriff_id.rfind(':');
  std::int64_t number = 0;
  if (colon != std::string::npos) {
    std::from_chars(sheriff_id.data() + colon + 1, sheriff_id.data() + sheriff_id.size(), number);
  }
  return time::from_utime(number);
}

}  // namespace

// The same form as the existing sheriff's id: host, process, time.
std::string sheriff_id_prefix() {
  return host_name() + ":" + std::to_string(::getpid()) + ":";
}

Fleet::Fleet(const Config& config, std::string sheriff_id) : sheriff_id_(std::move(sheriff_id)) {
  (void)reconfigure(config);
}

std::vector<std::string> Fleet::reconfigure(const Config& config) {
  std::vector<std::string> changes;
  std::vector<Item> before = std::exchange(items_, {});
  for (const Command& command : config.commands) {
    items_.push_back(configure(take_item(before, command), command, changes));
    deputies_.expect(command.deputy);
  }
  for (Item& item : before) {
    if (item.is_configured && !item.is_stop_ordered) {
      changes.push_back(item.spec.id + " is no longer configured: stopping it");
      item.force_quit = item.is_stop_ordered = true;
    }
    items_.push_back(std::move(item));
  }
  return changes;
}

// Removes the item of a command from `items` and returns it; empty if there is none.
std::optional<Fleet::Item> Fleet::take_item(std::vector<Item>& items, const Command& command) {
  const auto found = std::ranges::find_if(items, [&command](const Item& item) {
    return item.spec.id == command.id && item.deputy == command.deputy;
  });
  if (found == items.end()) {
    return std::nullopt;
  }
  Item item = std::move(*found);
  items.erase(found);
  return item;
}

// The item of a command as now configured. `before` is its item so far. Appends a line to
// `changes` if the command is new or has changed.
Fleet::Item Fleet::configure(std::optional<Item> before, const Command& command,
                             std::vector<std::string>& changes) {
  if (!before) {
    changes.push_back(command.id + " is new");
  } else if (before->spec.exec != command.exec) {
    changes.push_back(command.id + " has changed");
    if (before->desired_run != 0 && !before->force_quit) {
      begin_run(*before);
    }
  }
  Item item = before ? std::move(*before) : Item{};
  item.spec = spec_of(command);
  item.deputy = command.deputy;
  item.is_configured = true;
  return item;
}

const Fleet::Item* Fleet::find(const std::string& id) const {
  return find_in(items_, id);
}

void Fleet::order(Verb verb, const std::string& id) {
  switch (verb) {
    case Verb::kStart:
      start(id);
      break;
    case Verb::kStop:
      stop(id);
      break;
    case Verb::kRestart:
      restart(id);
      break;
  }
}

void Fleet::start(const std::string& id) {
  Item* item = find_in(items_, id);
  if (item == nullptr) {
    return;
  }
  const bool runs = has_process(*item);
  const bool starts =
      item->desired_run != 0 && (!item->status || item->status->actual_run != item->desired_run);
  if (!item->force_quit && (runs || starts)) {
    return;
  }
  begin_run(*item);
}

void Fleet::stop(const std::string& id) {
  if (Item* item = find_in(items_, id)) {
    item->force_quit = item->is_stop_ordered = true;
  }
}

void Fleet::restart(const std::string& id) {
  if (Item* item = find_in(items_, id)) {
    begin_run(*item);
  }
}

void Fleet::begin_run(Item& item) {
  item.desired_run = run_after(item.desired_run);
  item.force_quit = item.is_stop_ordered = false;
  item.failed_status.reset();
  item.respawns_until.reset();
}

// Back to the state before the deputy has reported it: what it reports next is adopted.
void Fleet::forget_orders(Item& item) {
  item.desired_run = 0;
  item.force_quit = item.is_stop_ordered = item.is_adopted = false;
  item.failed_status.reset();
}

bool Fleet::take_info(const DeputyInfo& info, time::SteadyTime now, const bus::Sender& sender) {
  if (!deputies_.take(info, now, sender)) {
    return false;
  }
  for (Item& item : items_) {
    if (item.deputy == info.deputy_id && !is_in_command()) {
      forget_orders(item);  // another sheriff may have given others since
    }
    if (item.deputy == info.deputy_id && !lists(info, item.spec.id)) {
      item.status.reset();
      item.is_adopted = true;
    }
  }
  newest_info_ = now;
  bool is_urgent = false;
  for (const CommandStatus& status : info.commands) {
    Item* item = find_or_add(status.spec, info.deputy_id);
    if (item != nullptr) {
      take_status(*item, status, now);
      is_urgent |= status.pid == 0 && !item->force_quit && item->desired_run != status.actual_run;
    }
  }
  return is_urgent;
}

// The item of a command that a deputy reports; null if it is unknown and there are too many, or
// ours of this name is on another host, which its own deputy reports.
Fleet::Item* Fleet::find_or_add(const CommandSpec& spec, const std::string& deputy) {
  if (Item* item = find_in(items_, spec.id, deputy)) {
    return item;
  }
  if (find_in(items_, spec.id) != nullptr || items_.size() >= kMaxItems) {
    return nullptr;
  }
  Item& added = items_.emplace_back();
  added.spec = spec;
  added.deputy = deputy;
  return &added;
}

// Takes over a command that another sheriff started. It continues as it is; orders already given to
// this sheriff still apply.
void Fleet::adopt(Item& item, const CommandStatus& status, time::SteadyTime now) {
  const bool start_wished = item.desired_run != 0 && !item.force_quit;
  const bool is_down = status.pid == 0;
  item.desired_run = start_wished && is_down ? run_after(status.actual_run) : status.actual_run;
  item.is_adopted = true;
  if (!start_wished && will_respawn(status)) {
    item.respawns_until = item.respawns_until.value_or(now + kRespawnTime);
    return;
  }
  item.force_quit |= !start_wished && is_down;
  // Nobody knows who stopped it. An end by the stop signal is taken as ordered, one by SIGKILL as
  // an error: the stop signal had no effect, or the system killed it.
  item.is_stop_ordered |= is_down && status.wait_status != SIGKILL;
}

void Fleet::take_status(Item& item, const CommandStatus& status, time::SteadyTime now) {
  if (!item.is_adopted) {
    adopt(item, status, now);
  }
  const std::int32_t pid_before = item.status ? item.status->pid : 0;
  const bool ended_by_itself = item.status && pid_before != 0 && status.pid == 0 &&
                               status.actual_run == item.desired_run && !item.force_quit &&
                               !item.spec.auto_respawn;
  if (status.pid != 0 && status.pid != pid_before) {
    item.num_restarts += item.running_since != time::SteadyTime{} ? 1 : 0;
    item.running_since = now;
  }
  // It may have run and ended between two INFOs: the run number tells. A restarted deputy must not
  // run it a second time.
  const bool ended_unseen = pid_before == 0 && status.pid == 0 && status.actual_run != 0 &&
                            status.actual_run == item.desired_run && !item.force_quit &&
                            !item.spec.auto_respawn;
  item.status = status;
  const bool is_this_run = status.pid == 0 && status.actual_run == item.desired_run;
  if (is_this_run && item.desired_run != 0 && !item.force_quit && !is_good_end(item)) {
    item.failed_status = status.wait_status;
  }
  if (status.pid != 0) {
    item.respawns_until.reset();
  }
  const bool was_stopped = item.respawns_until && now > *item.respawns_until;
  item.force_quit |= ended_by_itself || ended_unseen || was_stopped;
}

void Fleet::take_runs(const Runs& runs, time::SteadyTime now, const bus::Sender& sender) {
  if (!deputies_.follow(runs.deputy_id, now, sender)) {
    return;
  }
  for (const CommandRun& run : runs.runs) {
    if (Item* item = find_in(items_, run.command_id, runs.deputy_id)) {
      item->reported_run = Run{run.pid, now - run.uptime, run.num_restarts};
    }
  }
}

Fleet::Run Fleet::run_of(const Item& item) {
  const std::int32_t pid = item.status ? item.status->pid : 0;
  const bool is_reported = item.reported_run && item.reported_run->pid == pid;
  return is_reported ? *item.reported_run : Run{pid, item.running_since, item.num_restarts};
}

void Fleet::take_orders(const Orders& orders, time::SteadyTime now, const bus::Sender& sender) {
  if (orders.sheriff_id != sheriff_id_ && has_commands_for(orders.deputy_id)) {
    other_sheriffs_.take(orders.sheriff_id, sender, now);
  }
}

bool Fleet::has_commands_for(const std::string& deputy) const {
  return std::ranges::any_of(
      items_, [&deputy](const Item& item) { return item.is_configured && item.deputy == deputy; });
}

std::optional<Orders> Fleet::orders_for(const std::string& deputy, time::Timestamp stamp) const {
  if (deputies_.find(deputy) == nullptr || !has_commands_for(deputy)) {
    return std::nullopt;
  }
  Orders orders{stamp, deputy, sheriff_id_, {}};
  for (const Item& item : items_) {
    if (item.deputy == deputy) {
      orders.commands.push_back(
          {item.spec, item.desired_run, item.force_quit || waits_for_former_host(item)});
    }
  }
  return orders;
}

// A host that no longer reports is not waited for: it may have been the reason for the move.
bool Fleet::waits_for_former_host(const Item& item) const {
  return !has_process(item) && std::ranges::any_of(items_, [&](const Item& other) {
    return other.spec.id == item.spec.id && other.deputy != item.deputy && other.is_configured &&
           has_process(other) && deputies_.is_reporting(other.deputy, newest_info_);
  });
}

CommandState Fleet::state_of(const std::string& id, time::SteadyTime now) const {
  const Item* item = find(id);
  return item == nullptr ? CommandState::kUnknown : state_of(*item, now);
}

CommandState Fleet::state_of(const Item& item, time::SteadyTime now) const {
  if (!deputies_.is_reporting(item.deputy, now)) {
    return CommandState::kUnknown;
  }
  if (has_process(item)) {
    return state_of_running(item);
  }
  if (waits_for_former_host(item)) {
    return CommandState::kStopping;
  }
  const bool is_wanted = item.desired_run != 0 && !item.force_quit;
  const bool was_this_run = item.status && item.status->actual_run == item.desired_run;
  if (is_wanted && !was_this_run) {
    return CommandState::kStarting;
  }
  const bool is_good = !item.status || is_good_end(item);
  return is_good ? CommandState::kStoppedOk : CommandState::kStoppedError;
}

bool Fleet::is_running(const std::string& id, time::SteadyTime now) const {
  return state_of(id, now) == CommandState::kRunning;
}

bool Fleet::is_stopped(const std::string& id, time::SteadyTime now) const {
  const CommandState state = state_of(id, now);
  return state == CommandState::kStoppedOk || state == CommandState::kStoppedError;
}

bool Fleet::must_yield(time::SteadyTime now) const {
  const auto other = other_sheriffs_.running(now);
  const bool is_new_here = !commands_since_ || now - *commands_since_ < kYieldTime;
  return other && is_new_here && beginning_of(*other) <= beginning_of(sheriff_id_);
}

}  // namespace nodmap::procman
