// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/health_watch.hpp"

#include <algorithm>

namespace nodmap::procman {
namespace {

constexpr std::int64_t kSecondUs = 1'000'000;

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
                              std::int64_t now_us) {
  const bool is_ours =
      std::any_of(config_.commands.begin(), config_.commands.end(),
                  [&](const Command& command) { return status_name(command) == process_name; });
  if (!is_ours) {
    return;
  }
  Process& process = processes_[process_name];
  process.last = {health, now_us};
  if (health.state != ProcessHealth::State::kFailed) {
    process.failed_since_us.reset();
  } else if (!process.failed_since_us) {
    process.failed_since_us = now_us;
  }
}

void HealthWatch::take_output(const std::string& command_id, std::int64_t now_us) {
  if (config_.find_command(command_id) != nullptr) {
    written_us_[command_id] = now_us;
  }
}

std::optional<HealthWatch::LastStatus> HealthWatch::last_status_of(
    const std::string& command_id) const {
  const Command* command = config_.find_command(command_id);
  const auto found = command == nullptr ? processes_.end() : processes_.find(status_name(*command));
  return found == processes_.end() ? std::nullopt : std::optional(found->second.last);
}

/// Why a command is to be restarted; empty where it is not.
std::string HealthWatch::restart_reason(const Command& command, Span observed, int factor) const {
  const HealthRule& rule = command.health;
  const auto too_long = [factor](std::int64_t duration_us, std::optional<int> limit_s) {
    return limit_s && duration_us > kSecondUs * *limit_s * factor;
  };
  const auto written = written_us_.find(command.id);
  const std::int64_t mute_us =
      observed.until_us -
      std::max(observed.since_us, written == written_us_.end() ? 0 : written->second);
  if (too_long(mute_us, rule.restart_mute_s)) {
    return "no output for " + std::to_string(mute_us / kSecondUs) + " s";
  }
  const auto found = processes_.find(status_name(command));
  const bool has_status =
      found != processes_.end() && found->second.last.received_us >= observed.since_us;
  const std::int64_t silent_us =
      observed.until_us - (has_status ? found->second.last.received_us : observed.since_us);
  if (too_long(silent_us, rule.restart_silent_s)) {
    return "no STATUS for " + std::to_string(silent_us / kSecondUs) + " s";
  }
  if (!has_status || !found->second.failed_since_us) {
    return {};
  }
  const Process& process = found->second;
  const std::int64_t failed_us =
      process.last.received_us - std::max(observed.since_us, *process.failed_since_us);
  if (!too_long(failed_us, rule.restart_failed_s)) {
    return {};
  }
  return "FAILED for " + std::to_string(failed_us / kSecondUs) +
         " s: " + process.last.health.reason;
}

std::vector<HealthWatch::Restart> HealthWatch::due_restarts(const Fleet& fleet,
                                                            std::int64_t now_us) {
  std::vector<Restart> all;
  for (const Command& command : config_.commands) {
    const Fleet::Item* item = fleet.find(command.id);
    if (item == nullptr || fleet.state_of(command.id, now_us) != CommandState::kRunning) {
      continue;
    }
    const Fleet::DeputyItem& deputy = fleet.deputies().at(item->deputy).value();
    Patience& patience = patience_[command.id];
    const Span observed{
        std::max({item->running_since_us, patience.restarted_us, deputy.heard_since_us}),
        deputy.heard_us};
    std::string reason = restart_reason(command, observed, 1 << patience.doublings);
    if (!reason.empty()) {
      patience.doublings = std::min(kMaxDoublings, patience.doublings + 1);
      patience.restarted_us = now_us;
      all.push_back({command.id, std::move(reason)});
    } else if (now_us - observed.since_us > kForgiveUs &&
               restart_reason(command, observed, 1).empty()) {
      patience.doublings = 0;
    }
  }
  return all;
}

}  // namespace nodmap::procman
