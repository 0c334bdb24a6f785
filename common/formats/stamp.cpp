// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/stamp.hpp"

#include <algorithm>
#include <charconv>

namespace nodmap::formats {
namespace {

constexpr std::size_t kMaxSecondsDigits = 12;  // times a million still fits 64 bits

bool all_digits(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::optional<time::Timestamp> parse_stamp(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) {
    text.remove_prefix(1);
  }
  const std::size_t dot = std::min(text.find('.'), text.size());
  const std::string_view seconds = text.substr(0, dot);
  const std::string_view decimals = text.substr(std::min(dot + 1, text.size()));
  if (seconds.empty() || seconds.size() > kMaxSecondsDigits || !all_digits(seconds) ||
      !all_digits(decimals)) {
    return std::nullopt;
  }
  std::int64_t utime = 0;
  std::from_chars(seconds.data(), seconds.data() + seconds.size(), utime);
  for (std::size_t i = 0; i < 6; ++i) {
    utime = 10 * utime + (i < decimals.size() ? decimals[i] - '0' : 0);
  }
  return time::from_utime(negative ? -utime : utime);
}

}  // namespace nodmap::formats
