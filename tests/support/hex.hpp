// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace nodmap::test {

/// Parses bytes written as in the manuals: "02 80 03"; "00x21" is the byte 00 twenty-one times.
inline std::vector<std::uint8_t> hex(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const auto value = static_cast<std::uint8_t>(std::stoi(word.substr(0, 2), nullptr, 16));
    const std::size_t count = word.size() > 3 ? std::stoul(word.substr(3)) : 1;
    bytes.insert(bytes.end(), count, value);
  }
  return bytes;
}

inline std::vector<std::uint8_t> operator+(std::vector<std::uint8_t> first,
                                           const std::vector<std::uint8_t>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace nodmap::test
