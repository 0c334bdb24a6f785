// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/rotation.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>

namespace nodmap::logger {
namespace {

constexpr std::size_t kDateLength = 10;  // YYYY-MM-DD

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_date(std::string_view text) {
  if (text.size() != kDateLength) {
    return false;
  }
  for (std::size_t i = 0; i < kDateLength; ++i) {
    const bool is_dash = i == 4 || i == 7;
    if (is_dash ? text[i] != '-' : !is_digit(text[i])) {
      return false;
    }
  }
  return true;
}

// Far above any number in use, and safe to increment.
constexpr int kMaxNumber = 999'999'999;

std::string two_digits(int number) {
  return std::string(number < 10 ? 1 : 0, '0') + std::to_string(number);
}

// Parses ".NN" as written by two_digits(). Empty for any other text, so that a file of another
// program with a similar name is never taken for one of ours.
std::optional<int> parse_suffix(std::string_view text) {
  int number = 0;
  if (text.size() < 3 || text[0] != '.' || !std::all_of(text.begin() + 1, text.end(), is_digit) ||
      std::from_chars(text.data() + 1, text.data() + text.size(), number).ec != std::errc() ||
      number > kMaxNumber || text.substr(1) != two_digits(number)) {
    return std::nullopt;
  }
  return number;
}

}  // namespace

std::string utc_date(time::Timestamp stamp) {
  const std::chrono::sys_time<time::Duration> utc(stamp.time_since_epoch());
  const std::chrono::year_month_day day(std::chrono::floor<std::chrono::days>(utc));
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02u", static_cast<int>(day.year()),
                static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()));
  return text.data();
}

std::optional<LogOrder> LogNames::order_of(std::string_view name) const {
  if (!name.starts_with(stem_)) {
    return std::nullopt;
  }
  std::string_view rest = name.substr(stem_.size());
  LogOrder order;
  if (is_dated_) {
    if (rest.size() <= kDateLength || rest[0] != '-' || !is_date(rest.substr(1, kDateLength))) {
      return std::nullopt;
    }
    order.date = rest.substr(1, kDateLength);
    rest.remove_prefix(1 + kDateLength);
  } else if (rest.empty()) {
    return order;
  }
  const std::optional<int> number = parse_suffix(rest);
  if (!number || (!is_dated_ && *number == 0)) {
    return std::nullopt;
  }
  order.number = *number;
  return order;
}

std::string LogNames::next(time::Timestamp begin, std::span<const std::string> existing) const {
  LogOrder order{is_dated_ ? utc_date(begin) : std::string(), 0};
  for (const std::string& name : existing) {
    const std::optional<LogOrder> taken = order_of(name);
    if (taken && *taken >= order) {
      order = {taken->date, taken->number + 1};
    }
  }
  return name_of(order);
}

std::string LogNames::name_of(const LogOrder& order) const {
  if (!is_dated_) {
    return order.number == 0 ? stem_ : stem_ + "." + two_digits(order.number);
  }
  return stem_ + "-" + order.date + "." + two_digits(order.number);
}

bool must_split(std::int64_t size_bytes, std::int64_t next_event_bytes, std::int64_t split_bytes) {
  return split_bytes > 0 && size_bytes > 0 && size_bytes + next_event_bytes > split_bytes;
}

}  // namespace nodmap::logger
