// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/deputy_reports.hpp"

#include <cstddef>

namespace nodmap::procman {
namespace {

// Far more than any robot has. Any sender on the network can name any number of hosts.
constexpr std::size_t kMaxDeputies = 256;

}  // namespace

bool DeputyReports::take(const DeputyInfo& info, time::SteadyTime now, const bus::Sender& sender) {
  if (!reports_.contains(info.deputy_id) && reports_.size() >= kMaxDeputies) {
    return false;
  }
  if (!senders_.try_emplace(info.deputy_id, kSilence).first->second.follow(sender, now)) {
    return false;
  }
  std::optional<Report>& report = reports_[info.deputy_id];
  const bool is_gap = !report || now - report->received > kInfoGap;
  report = Report{info, now, is_gap ? now : report->reporting_since};
  return true;
}

bool DeputyReports::follow(const std::string& deputy, time::SteadyTime now,
                           const bus::Sender& sender) {
  const auto found = senders_.find(deputy);
  return found == senders_.end() || found->second.follow(sender, now);
}

const DeputyReports::Report* DeputyReports::find(const std::string& deputy) const {
  const auto found = reports_.find(deputy);
  return found == reports_.end() || !found->second ? nullptr : &*found->second;
}

bool DeputyReports::is_reporting(const std::string& deputy, time::SteadyTime now) const {
  const Report* report = find(deputy);
  return report != nullptr && now - report->received <= kMaxInfoAge;
}

std::optional<bus::Sender> DeputyReports::sender_of(const std::string& deputy,
                                                    time::SteadyTime now) const {
  const auto found = senders_.find(deputy);
  return found == senders_.end() ? std::nullopt : found->second.accepted(now);
}

std::vector<std::string> DeputyReports::contested(time::SteadyTime now) const {
  std::vector<std::string> names;
  for (const auto& [deputy, sender] : senders_) {
    if (sender.is_contested(now)) {
      names.push_back(deputy);
    }
  }
  return names;
}

}  // namespace nodmap::procman
