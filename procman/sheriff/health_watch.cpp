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

std::string status_name(const Command& command) {
  if (!command.health.status_name.empty()) {
    return command.health.status_name;
  }
  // The first word that is no assignment; our programs need no quotes.
  std::size_t at = 0;
  while (at < command.exec.size()) {
    const std::size_t begin =
        std::min(command.exec.find_first_not_of(' ', at), command.exec.size());
    at = std::min(command.exec.find(' ', begin), command.exec.size());
    const std::string word = command.exec.substr(begin, at - begin);
    if (word.find('=') == std::string::npos) {
      return word.substr(word.rfind('/') + 1);
    }
  }
  return {};
}

void HealthWatch::take_status(const std::string& process_name, const ProcessHealth& health,
                              std::int64_t now_us) {
  Voice& voice = voices_[process_name];
  voice.health = health;
  voice.heard_us = now_us;
  if (health.state != ProcessHealth::State::kFailed) {
    voice.failed_since_us.reset();
  } else if (!voice.failed_since_us) {
    voice.failed_since_us = now_us;
  }
}

std::optional<ProcessHealth> HealthWatch::health_of(const std::string& command_id) const {
  const Command* command = config_.find_command(command_id);
  const auto found = command == nullptr ? voices_.end() : voices_.find(status_name(*command));
  return found == voices_.end() ? std::nullopt : std::optional(found->second.health);
}

/// Why a command is to be restarted; empty where it is not.
std::string HealthWatch::complaint(const Command& command, Span heard, int factor) const {
  const HealthRule& rule = command.health;
  const auto found = voices_.find(status_name(command));
  const bool has_spoken = found != voices_.end() && found->second.heard_us >= heard.since_us;
  const std::int64_t silent_us =
      heard.until_us - (has_spoken ? found->second.heard_us : heard.since_us);
  if (rule.restart_silent_s && silent_us > kSecondUs * *rule.restart_silent_s * factor) {
    return "no STATUS for " + std::to_string(silent_us / kSecondUs) + " s";
  }
  if (!rule.restart_failed_s || !has_spoken || !found->second.failed_since_us) {
    return {};
  }
  const std::int64_t failed_us =
      found->second.heard_us - std::max(heard.since_us, *found->second.failed_since_us);
  if (failed_us <= kSecondUs * *rule.restart_failed_s * factor) {
    return {};
  }
  return "FAILED for " + std::to_string(failed_us / kSecondUs) +
         " s: " + found->second.health.reason;
}

std::vector<HealthWatch::Verdict> HealthWatch::verdicts(const Fleet& fleet, std::int64_t now_us) {
  std::vector<Verdict> all;
  for (const Command& command : config_.commands) {
    const Fleet::Item* item = fleet.find(command.id);
    if (item == nullptr || fleet.state_of(command.id, now_us) != CommandState::kRunning) {
      continue;
    }
    const Fleet::DeputyItem& deputy = fleet.deputies().at(item->deputy).value();
    Patience& patience = patience_[command.id];
    const Span heard{
        std::max({item->running_since_us, patience.restarted_us, deputy.heard_since_us}),
        deputy.heard_us};
    std::string reason = complaint(command, heard, 1 << patience.doublings);
    if (!reason.empty()) {
      patience.doublings = std::min(kMaxDoublings, patience.doublings + 1);
      patience.restarted_us = now_us;
      all.push_back({command.id, std::move(reason)});
    } else if (now_us - heard.since_us > kForgiveUs && complaint(command, heard, 1).empty()) {
      patience.doublings = 0;
    }
  }
  return all;
}

}  // namespace nodmap::procman
