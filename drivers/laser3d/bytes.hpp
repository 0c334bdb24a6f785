// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace nodmap::laser3d {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// Little-endian numbers, as both devices send them. The caller has checked that they are there.
[[nodiscard]] constexpr std::uint16_t read_u16(ByteView bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8));
}

[[nodiscard]] constexpr std::uint32_t read_u32(ByteView bytes, std::size_t at) {
  return read_u16(bytes, at) | (static_cast<std::uint32_t>(read_u16(bytes, at + 2)) << 16);
}

[[nodiscard]] constexpr std::int32_t read_i32(ByteView bytes, std::size_t at) {
  return static_cast<std::int32_t>(read_u32(bytes, at));
}

constexpr void append_u16(Bytes& bytes, std::uint16_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8));
}

constexpr void append_u32(Bytes& bytes, std::uint32_t value) {
  append_u16(bytes, static_cast<std::uint16_t>(value & 0xFFFFU));
  append_u16(bytes, static_cast<std::uint16_t>(value >> 16));
}

constexpr void append(Bytes& bytes, ByteView more) {
  for (const std::uint8_t byte : more) {
    bytes.push_back(byte);
  }
}

}  // namespace nodmap::laser3d
