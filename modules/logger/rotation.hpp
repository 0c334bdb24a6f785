// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "common/geometry/time.hpp"

namespace nodmap::logger {

/// The position of a log file in the order of its family: later files compare greater.
struct LogOrder {
  std::string date;  ///< YYYY-MM-DD; empty for names without a date
  int number = 0;
  // NOLINTNEXTLINE(modernize-use-nullptr): takes the 0 inside of <=> for a pointer
  auto operator<=>(const LogOrder&) const = default;
};

/// The family of names that a logger gives to its successive files.
class LogNames {
 public:
  /// lcmlog-YYYY-MM-DD.NN: the day in UTC, so that names never step back, and numbers from 00.
  [[nodiscard]] static LogNames dated(std::string prefix) { return {std::move(prefix), true}; }

  /// `name` itself, then name.01, name.02, ...
  [[nodiscard]] static LogNames fixed(std::string name) { return {std::move(name), false}; }

  /// The position of a file in this family; nothing for any other name.
  [[nodiscard]] std::optional<LogOrder> order_of(std::string_view name) const;

  /// The name of a new file begun at `begin`. It comes after all of `existing`, so the order of
  /// names is the order of recording, even if the clock was set back: then the name continues the
  /// numbers of the newest date.
  [[nodiscard]] std::string next(time::Timestamp begin,
                                 std::span<const std::string> existing) const;

 private:
  LogNames(std::string stem, bool is_dated) : stem_(std::move(stem)), is_dated_(is_dated) {}

  [[nodiscard]] std::string name_of(const LogOrder& order) const;

  std::string stem_;
  bool is_dated_;
};

/// Whether to begin a new file before the next event. An event larger than `split_bytes` gets a
/// file of its own; 0: never split.
[[nodiscard]] bool must_split(std::int64_t size_bytes, std::int64_t next_event_bytes,
                              std::int64_t split_bytes);

/// The UTC date of a time, YYYY-MM-DD.
[[nodiscard]] std::string utc_date(time::Timestamp stamp);

}  // namespace nodmap::logger
