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
  std::string type;  ///< type of the first message; its fingerprint if the type is unknown
  std::int64_t count = 0;
  std::int64_t corrupt = 0;  ///< damaged, or of another type than the first
  /// Messages with an earlier time of measurement than the previous one.
  std::int64_t steps_back = 0;
  std::int64_t size_bytes = 0;
  time::Timestamp first{};
  time::Timestamp last{};
  time::Duration longest_gap{};

  [[nodiscard]] double duration_s() const { return time::seconds(last - first); }
  /// Messages per second; 0 for a single one.
  [[nodiscard]] double rate_hz() const {
    return duration_s() > 0.0 ? static_cast<double>(count - 1) / duration_s() : 0.0;
  }

  time::Timestamp previous{};  ///< when the previous message was logged
  time::Timestamp last_measured{};
};

/// The content of an event log.
struct LogSummary {
  std::map<std::string, ChannelSummary> channels;
  std::int64_t skipped_bytes = 0;

  void add(const bus::LogEvent& event);
};

[[nodiscard]] LogSummary summarize_log(const std::filesystem::path& log);

/// Prints a table for people.
void print(std::ostream& out, const LogSummary& summary);

}  // namespace nodmap::convert
