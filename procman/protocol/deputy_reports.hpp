// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/sender.hpp"
#include "common/bus/sender_watch.hpp"
#include "common/geometry/time.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

/// The newest INFO of each deputy. Those of one deputy are taken from one sender, until that has
/// been silent for kSilence.
class DeputyReports {
 public:
  /// An INFO older than this is not used: four in a row may be lost. The existing sheriff waits 30
  /// s; here a dead host is noticed before anyone waits for it.
  static constexpr time::Duration kMaxInfoAge = 5s;
  /// Two INFOs farther apart than this mean that some were lost, and perhaps STATUS with them.
  static constexpr time::Duration kInfoGap = 1500ms;
  /// A deputy that is silent for this long has missed two INFOs.
  static constexpr time::Duration kSilence = 2s;

  struct Report {
    DeputyInfo info;
    time::SteadyTime received{};         ///< when the newest INFO arrived
    time::SteadyTime reporting_since{};  ///< no INFO has been lost since then
  };

  /// Lists a deputy that has not reported yet. There is always room for it.
  void expect(const std::string& deputy) { reports_.try_emplace(deputy); }

  /// Takes an INFO. Returns false if it is from a second sender, or there are too many deputies.
  [[nodiscard]] bool take(const DeputyInfo& info, time::SteadyTime now, const bus::Sender& sender);

  /// Whether a further message of a deputy comes from where its INFOs come from, as far as known.
  [[nodiscard]] bool follow(const std::string& deputy, time::SteadyTime now,
                            const bus::Sender& sender);

  /// All deputies that report, have reported or are expected.
  [[nodiscard]] const std::map<std::string, std::optional<Report>>& all() const { return reports_; }
  /// The newest report of a deputy; null before its first.
  [[nodiscard]] const Report* find(const std::string& deputy) const;
  /// Whether INFO of a deputy was received recently.
  [[nodiscard]] bool is_reporting(const std::string& deputy, time::SteadyTime now) const;
  /// Where a deputy sends from; empty while it does not report.
  [[nodiscard]] std::optional<bus::Sender> sender_of(const std::string& deputy,
                                                     time::SteadyTime now) const;
  /// The deputies in whose name a second process reports.
  [[nodiscard]] std::vector<std::string> contested(time::SteadyTime now) const;

 private:
  std::map<std::string, std::optional<Report>> reports_;
  std::map<std::string, bus::SenderWatch> senders_;
};

}  // namespace nodmap::procman
