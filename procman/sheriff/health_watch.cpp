// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/health_watch.hpp"

#include <algorithm>

namespace nodmap::procman {
namespace {

// For a sentence: whole seconds with their unit.
std::string whole_seconds(time::Duration duration) {
  return std::to_string(duration / 1s) + " s";
}

// Whether a message can be from a command's process: it runs, on the sender's host, as far as that
// is known.
bool may_send(const Command& command, const Fleet& fleet, time::SteadyTime now,
              const bus::Sender& sender) {
  const std::optional<bus::Sender> deputy = fleet.deputies().sender_of(command.deputy, now);
  const Fleet::Item* item = fleet.find(command.id);
  const bool is_stopped = item != nullptr && item->status && item->status->pid == 0;
  return !is_stopped && (!deputy || deputy->address == sender.address);
}

}  // namespace

const char* name_of(ProcessHealth::State state) {
  switch (state) {
    case ProcessHealth::State::kOk:
      return "OK";
    case ProcessHealth::State::kDegraded:
      return "DEGRADED";
    default:
      return "FAILED";
  }
}

// The process that sends a STATUS. Several commands may run the same program: it is that of the
// one whose STATUS came from this socket before, else of the first that has sent none. If there is
// neither, the sender is a stranger to one of them. Null if no running command has this program.
HealthWatch::Process* HealthWatch::process_of(const std::string& process_name, const Fleet& fleet,
                                              time::SteadyTime now, const bus::Sender& sender) {
  Process* silent = nullptr;
  Process* other = nullptr;
  for (const Command& command : config_.commands) {
    if (status_name(command) != process_name || !may_send(command, fleet, now, sender)) {
      continue;
    }
    Process& process = processes_[command.id];
    const Fleet::Item* item = fleet.find(command.id);
    if (item != nullptr && process.last && process.last->received < item->running_since) {
      process.sender = bus::SenderWatch(node::kStatusSilence);  // it was that of the run before
    }
    const std::optional<bus::Sender> accepted = process.sender.accepted(now);
    if (accepted == sender) {
      return &process;
    }
    if (!accepted && silent == nullptr) {
      silent = &process;
    } else {
      other = &process;
    }
  }
  return silent != nullptr ? silent : other;
}

void HealthWatch::take_status(const std::string& process_name, const ProcessHealth& health,
                              const Fleet& fleet, time::SteadyTime now, const bus::Sender& sender) {
  Process* process = process_of(process_name, fleet, now, sender);
  if (process == nullptr || !process->sender.follow(sender, now)) {
    return;
  }
  process->last = LastStatus{health, now};
  const auto keep_since = [now](std::optional<time::SteadyTime>& since, bool holds) {
    since = holds ? std::optional(since.value_or(now)) : std::nullopt;
  };
  keep_since(process->failed_since, health.state == ProcessHealth::State::kFailed);
  keep_since(process->degraded_since, health.state != ProcessHealth::State::kOk);
}

std::set<std::string> HealthWatch::contested_names(time::SteadyTime now) const {
  std::set<std::string> names;
  for (const Command& command : config_.commands) {
    const auto found = processes_.find(command.id);
    if (found != processes_.end() && found->second.sender.is_contested(now)) {
      names.insert(status_name(command));
    }
  }
  return names;
}

void HealthWatch::take_output(const std::string& command_id, time::SteadyTime now) {
  if (config_.find_command(command_id) != nullptr) {
    written_[command_id] = now;
  }
}

std::optional<HealthWatch::LastStatus> HealthWatch::last_status_of(
    const std::string& command_id) const {
  const auto found = processes_.find(command_id);
  return found == processes_.end() ? std::nullopt : found->second.last;
}

// Why a command must be restarted; empty if it must not.
std::string HealthWatch::restart_reason(const Command& command, Span observed, int factor) const {
  const HealthRule& rule = command.health;
  const auto too_long = [factor](time::Duration duration, std::optional<int> limit_s) {
    return limit_s && duration > 1s * *limit_s * factor;
  };
  const auto written = written_.find(command.id);
  const time::Duration mute =
      observed.until -
      std::max(observed.since, written == written_.end() ? time::SteadyTime{} : written->second);
  if (too_long(mute, rule.restart_mute_s)) {
    return "no output for " + whole_seconds(mute);
  }
  const auto found = processes_.find(command.id);
  const std::optional<LastStatus> last = last_status_of(command.id);
  const bool has_status = last && last->received >= observed.since;
  const time::Duration silent = observed.until - (has_status ? last->received : observed.since);
  if (too_long(silent, rule.restart_silent_s)) {
    return "no STATUS for " + whole_seconds(silent);
  }
  if (!has_status) {
    return {};
  }
  const Process& process = found->second;
  const auto lasting = [&](std::optional<time::SteadyTime> since) {
    return since ? last->received - std::max(observed.since, *since) : time::Duration{};
  };
  const auto reason = [&last](const char* state, time::Duration duration) {
    return state + whole_seconds(duration) + ": " + last->health.reason;
  };
  if (too_long(lasting(process.failed_since), rule.restart_failed_s)) {
    return reason("FAILED for ", lasting(process.failed_since));
  }
  if (too_long(lasting(process.degraded_since), rule.restart_degraded_s)) {
    return reason("DEGRADED for ", lasting(process.degraded_since));
  }
  return {};
}

std::vector<HealthWatch::Restart> HealthWatch::due_restarts(const Fleet& fleet,
                                                            time::SteadyTime now) {
  std::vector<Restart> all;
  for (const Command& command : config_.commands) {
    const Fleet::Item* item = fleet.find(command.id);
    if (item == nullptr || fleet.state_of(command.id, now) != CommandState::kRunning) {
      continue;
    }
    const DeputyReports::Report& deputy = *fleet.deputies().find(item->deputy);
    Patience& patience = patience_[command.id];
    const Span observed{std::max({item->running_since, patience.restarted, deputy.reporting_since}),
                        deputy.received};
    std::string reason = restart_reason(command, observed, 1 << patience.doublings);
    if (!reason.empty()) {
      patience.doublings = std::min(kMaxDoublings, patience.doublings + 1);
      patience.restarted = now;
      all.push_back({command.id, std::move(reason)});
    } else if (now - observed.since > kForgiveTime &&
               restart_reason(command, observed, 1).empty()) {
      patience.doublings = 0;
    }
  }
  return all;
}

}  // namespace nodmap::procman
