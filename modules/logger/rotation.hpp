// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace nodmap::logger {

/// Where a log stands among those of its family: later files compare greater.
struct LogOrder {
  std::string date;  ///< YYYY-MM-DD, or empty where names bear none
  int number = 0;
  // NOLINTNEXTLINE(modernize-use-nullptr): takes the 0 inside of <=> for a pointer
  auto operator<=>(const LogOrder&) const = default;
};

/// The family of names a logger gives to its files, one after the other.
class LogNames {
 public:
  /// lcmlog-YYYY-MM-DD.NN: the day in UTC, so that names never step back, and numbers from 00.
  [[nodiscard]] static LogNames dated(std::string prefix) { return {std::move(prefix), true}; }

  /// `name` itself, then name.01, name.02, ...
  [[nodiscard]] static LogNames fixed(std::string name) { return {std::move(name), false}; }

  /// The order of a file of this family; nothing for any other name.
  [[nodiscard]] std::optional<LogOrder> order_of(std::string_view name) const;

  /// A name for a file begun at `utime_us` that comes after all of `existing`, so that the order of
  /// names is the order of recording. (A day before the newest one, by a clock set back, counts on
  /// from that one.)
  [[nodiscard]] std::string next(std::int64_t utime_us,
                                 std::span<const std::string> existing) const;

 private:
  LogNames(std::string stem, bool is_dated) : stem_(std::move(stem)), is_dated_(is_dated) {}

  [[nodiscard]] std::string name_of(const LogOrder& order) const;

  std::string stem_;
  bool is_dated_;
};

/// Whether the next event belongs into a new file. An event larger than the limit gets a file of
/// its own; `split_bytes` 0: never.
[[nodiscard]] bool must_split(std::int64_t size_bytes, std::int64_t next_event_bytes,
                              std::int64_t split_bytes);

/// The day of a time, YYYY-MM-DD in UTC.
[[nodiscard]] std::string utc_date(std::int64_t utime_us);

}  // namespace nodmap::logger
