// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/printable.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace nodmap::procman {
namespace {

bool begins_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // not a continuation byte
}

// Length of the UTF-8 sequence that begins with this byte; 0 if none does.
std::size_t sequence_length(unsigned char first) {
  if (first < 0x80) {
    return 1;
  }
  return first >> 5U == 6 ? 2 : first >> 4U == 14 ? 3 : first >> 3U == 30 ? 4 : 0;
}

// Length in bytes of the character at the start of `text`; 0 if it must not be sent to a terminal.
std::size_t good_character(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = sequence_length(byte(0));
  if (length > text.size() || byte(0) < 0x20 || byte(0) == 0x7F) {
    return 0;
  }
  constexpr std::array<unsigned, 5> kFirstBits{0, 0x7F, 0x1F, 0x0F, 0x07};
  constexpr std::array<unsigned, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  unsigned code_point = length == 0 ? 0 : byte(0) & kFirstBits[length];
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) {
      return 0;
    }
    code_point = code_point << 6U | (byte(i) & 0x3FU);
  }
  const bool is_overlong = code_point < kLeast[length];
  const bool is_none = (code_point >= 0xD800 && code_point < 0xE000) || code_point > 0x10FFFF;
  const bool steers = code_point >= 0x80 && code_point < 0xA0;  // these control terminals, too
  return is_overlong || is_none || steers ? 0 : length;
}

}  // namespace

std::string printable(const std::string& text) {
  std::string clean;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t length = good_character(std::string_view(text).substr(at));
    clean += length != 0 ? text.substr(at, length) : "?";
    at += std::max<std::size_t>(1, length);
  }
  return clean;
}

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_character));
}

std::string fitted(const std::string& text, std::size_t width) {
  std::size_t at = 0;
  std::size_t count = 0;
  for (; at < text.size(); ++at) {
    count += begins_character(text[at]) ? 1 : 0;
    if (count > width) {
      break;
    }
  }
  return text.substr(0, at);
}

}  // namespace nodmap::procman
