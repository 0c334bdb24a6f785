// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <ostream>
#include <string>

#include "common/bus/event_log.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::convert {

/// One channel of a log. Times are log times.
struct ChannelSummary {
  std::string type;  ///< of the first message; its fingerprint where the type is not known
  std::int64_t count = 0;
  std::int64_t corrupt = 0;     ///< damaged, or of another type than the first
  std::int64_t steps_back = 0;  ///< messages measured before the one that precedes them
  std::int64_t size_bytes = 0;
  time::Timestamp first{};
  time::Timestamp last{};
  time::Duration longest_gap{};

  [[nodiscard]] double duration_s() const { return time::seconds(last - first); }
  /// Messages per second; 0 for a single one.
  [[nodiscard]] double rate_hz() const {
    return duration_s() > 0.0 ? static_cast<double>(count - 1) / duration_s() : 0.0;
  }

  time::Timestamp last_measured{};
};

/// What is in an event log.
struct LogSummary {
  std::map<std::string, ChannelSummary> channels;
  std::int64_t skipped_bytes = 0;

  void add(const bus::LogEvent& event);
};

[[nodiscard]] LogSummary summarize_log(const std::filesystem::path& log);

/// A table for people.
void print(std::ostream& out, const LogSummary& summary);

}  // namespace nodmap::convert
