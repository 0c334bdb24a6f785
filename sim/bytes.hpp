// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace nodmap::sim {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// For Device::next_us(): nothing to do.
inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

inline void append(Bytes& bytes, ByteView more) {
  for (const std::uint8_t byte : more) {
    bytes.push_back(byte);
  }
}

/// `count` bytes of a number, the lowest first.
inline void append_little_endian(Bytes& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xFFU));
  }
}

/// A number from its bytes, the lowest first; at most four of them.
[[nodiscard]] inline std::uint32_t little_endian(ByteView bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) {
    value = value << 8U | bytes[i - 1];
  }
  return value;
}

}  // namespace nodmap::sim
