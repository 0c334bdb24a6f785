// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/other_sheriffs.hpp"

#include <algorithm>
#include <cstddef>

namespace nodmap::procman {
namespace {

// Far more than there are. Anybody can send from any number of sockets.
constexpr std::size_t kMaxSheriffs = 16;

bool is_recent(time::SteadyTime last, time::SteadyTime now) {
  return now - last <= OtherSheriffs::kSilence;
}

}  // namespace

void OtherSheriffs::take(const std::string& sheriff_id, const bus::Sender& sender,
                         time::SteadyTime now) {
  std::erase_if(sources_, [now](const auto& entry) { return !is_recent(entry.second.last, now); });
  if (!sources_.contains(sender) && sources_.size() >= kMaxSheriffs) {
    return;
  }
  Source& source = sources_.try_emplace(sender, Source{sheriff_id, now, now}).first->second;
  source.sheriff_id = sheriff_id;
  source.last = now;
}

std::optional<std::string> OtherSheriffs::running(time::SteadyTime now) const {
  return find(now, kRepeated);
}

std::optional<std::string> OtherSheriffs::received(time::SteadyTime now) const {
  return find(now, 0s);
}

// A sheriff that has been giving orders for this long, and did so recently.
std::optional<std::string> OtherSheriffs::find(time::SteadyTime now,
                                               time::Duration repeated) const {
  const auto found = std::ranges::find_if(sources_, [&](const auto& entry) {
    const Source& source = entry.second;
    return is_recent(source.last, now) && source.last - source.first >= repeated;
  });
  return found == sources_.end() ? std::nullopt : std::optional(found->second.sheriff_id);
}

}  // namespace nodmap::procman
