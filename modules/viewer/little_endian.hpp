// SPDX-License-Identifier: BSD-3-Clause
// Numbers in the binary frames of Foxglove's WebSocket protocol.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace nodmap::viewer {

template <class Unsigned>
void append_little_endian(std::string& bytes, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xFFU));
  }
}

/// Of the first four bytes, which must be there.
inline std::uint32_t read_little_endian(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < sizeof(value); ++i) {
    value |= static_cast<std::uint32_t>(bytes[i]) << (8U * i);
  }
  return value;
}

}  // namespace nodmap::viewer
