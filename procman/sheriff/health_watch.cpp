// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/health_watch.hpp"

#include <algorithm>

namespace nodmap::procman {
namespace {

/// For a sentence: whole seconds with their unit.
std::string whole_seconds(time::Duration duration) {
  return std::to_string(duration / 1s) + " s";
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

void HealthWatch::take_status(const std::string& process_name, const ProcessHealth& health,
                              time::SteadyTime now) {
  const bool is_ours =
      std::any_of(config_.commands.begin(), config_.commands.end(),
                  [&](const Command& command) { return status_name(command) == process_name; });
  if (!is_ours) {
    return;
  }
  Process& process = processes_[process_name];
  process.last = {health, now};
  const auto keep_since = [now](std::optional<time::SteadyTime>& since, bool holds) {
    since = holds ? std::optional(since.value_or(now)) : std::nullopt;
  };
  keep_since(process.failed_since, health.state == ProcessHealth::State::kFailed);
  keep_since(process.degraded_since, health.state != ProcessHealth::State::kOk);
}

void HealthWatch::take_output(const std::string& command_id, time::SteadyTime now) {
  if (config_.find_command(command_id) != nullptr) {
    written_[command_id] = now;
  }
}

std::optional<HealthWatch::LastStatus> HealthWatch::last_status_of(
    const std::string& command_id) const {
  const Command* command = config_.find_command(command_id);
  const auto found = command == nullptr ? processes_.end() : processes_.find(status_name(*command));
  return found == processes_.end() ? std::nullopt : std::optional(found->second.last);
}

/// Why a command must be restarted; empty if it must not.
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
  const auto found = processes_.find(status_name(command));
  const bool has_status =
      found != processes_.end() && found->second.last.received >= observed.since;
  const time::Duration silent =
      observed.until - (has_status ? found->second.last.received : observed.since);
  if (too_long(silent, rule.restart_silent_s)) {
    return "no STATUS for " + whole_seconds(silent);
  }
  if (!has_status) {
    return {};
  }
  const Process& process = found->second;
  const auto lasting = [&](std::optional<time::SteadyTime> since) {
    return since ? process.last.received - std::max(observed.since, *since) : time::Duration{};
  };
  const auto reason = [&process](const char* state, time::Duration duration) {
    return state + whole_seconds(duration) + ": " + process.last.health.reason;
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
    const Fleet::DeputyItem& deputy = fleet.deputies().at(item->deputy).value();
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
