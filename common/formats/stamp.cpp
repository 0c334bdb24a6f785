// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/stamp.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>

namespace nodmap::formats {
namespace {

constexpr int kMaxSecondsDigits = 12;  // times a million still fits 64 bits
constexpr int kMicrosecondDigits = 6;

bool all_digits(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

// The exponent at the end of a number, "e+09", which is removed; 0 without one, and empty if it is
// no number.
std::optional<int> take_exponent(std::string_view& text) {
  const std::size_t e = text.find_first_of("eE");
  if (e == std::string_view::npos) {
    return 0;
  }
  std::string_view digits = text.substr(e + 1);
  digits.remove_prefix(digits.starts_with('+') && !digits.starts_with("+-") ? 1 : 0);
  text = text.substr(0, e);
  int exponent = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  const bool is_number = error == std::errc() && end == digits.data() + digits.size();
  return is_number && std::abs(exponent) <= kMaxSecondsDigits ? std::optional(exponent)
                                                              : std::nullopt;
}

}  // namespace

std::optional<time::Timestamp> parse_stamp(std::string_view text) {
  const bool negative = text.starts_with('-');
  text.remove_prefix(negative ? 1 : 0);
  const auto exponent = take_exponent(text);
  const std::size_t dot = std::min(text.find('.'), text.size());
  const std::string_view seconds = text.substr(0, dot);
  const std::string_view decimals = text.substr(std::min(dot + 1, text.size()));
  if (!exponent || seconds.empty() || seconds.size() > kMaxSecondsDigits || !all_digits(seconds) ||
      !all_digits(decimals)) {
    return std::nullopt;
  }
  const int num_seconds_digits = static_cast<int>(seconds.size()) + *exponent;
  if (num_seconds_digits > kMaxSecondsDigits) {
    return std::nullopt;
  }
  const std::string digits = std::string(seconds).append(decimals);
  const auto digit = [&digits](int place) {
    const auto i = static_cast<std::size_t>(place);
    return place >= 0 && i < digits.size() ? digits[i] - '0' : 0;
  };
  const int num_digits = num_seconds_digits + kMicrosecondDigits;
  std::int64_t utime = 0;
  for (int place = 0; place < num_digits; ++place) {
    utime = 10 * utime + digit(place);
  }
  utime += digit(num_digits) >= 5 ? 1 : 0;
  return time::from_utime(negative ? -utime : utime);
}

}  // namespace nodmap::formats
