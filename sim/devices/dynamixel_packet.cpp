// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/dynamixel_packet.hpp"

#include <algorithm>
#include <array>

namespace nodmap::sim {
namespace {

constexpr std::array<std::uint8_t, 4> kHeader = {0xFF, 0xFF, 0xFD, 0x00};
constexpr std::array<std::uint8_t, 3> kLooksLikeHeader = {0xFF, 0xFF, 0xFD};
constexpr std::size_t kPrefixBytes = 7;  // header, id, length
constexpr std::size_t kLongest = 256;
constexpr std::uint8_t kStatus = 0x55;

bool header_at(ByteView bytes, std::size_t at) {
  return at + 3 <= bytes.size() && std::equal(kLooksLikeHeader.begin(), kLooksLikeHeader.end(),
                                              bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

// Where a header begins, or may begin when more bytes arrive.
std::ptrdiff_t header_start(const Bytes& bytes) {
  auto start = bytes.begin();
  while (!std::equal(start, start + std::min<std::ptrdiff_t>(kHeader.size(), bytes.end() - start),
                     kHeader.begin())) {
    ++start;
  }
  return start - bytes.begin();
}

// Byte stuffing: an additional FD after everything that looks like a header.
Bytes stuffed(ByteView content) {
  Bytes bytes;
  for (std::size_t i = 0; i < content.size(); ++i) {
    bytes.push_back(content[i]);
    if (i >= 2 && header_at(content, i - 2)) {
      bytes.push_back(0xFD);
    }
  }
  return bytes;
}

Bytes unstuffed(ByteView content) {
  Bytes bytes;
  for (std::size_t i = 0; i < content.size(); ++i) {
    const bool is_stuffing = i >= 3 && content[i] == 0xFD && header_at(content, i - 3);
    if (!is_stuffing) {
      bytes.push_back(content[i]);
    }
  }
  return bytes;
}

}  // namespace

std::uint16_t dynamixel_checksum(ByteView bytes) {
  std::uint32_t remainder = 0;
  for (const std::uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool carry = ((remainder >> 15U) & 1U) != (byte >> bit & 1U);
      remainder = (remainder << 1U) & 0xFFFFU;
      remainder ^= carry ? 0x8005U : 0U;
    }
  }
  return static_cast<std::uint16_t>(remainder);
}

Bytes dynamixel_status(std::uint8_t id, DynamixelError error, bool alert, ByteView parameters) {
  Bytes content = {static_cast<std::uint8_t>(static_cast<unsigned>(error) | (alert ? 0x80U : 0U))};
  append(content, parameters);
  content = stuffed(content);
  Bytes bytes(kHeader.begin(), kHeader.end());
  bytes.push_back(id);
  append_little_endian(bytes, static_cast<std::uint32_t>(content.size() + 3), 2);
  bytes.push_back(kStatus);
  append(bytes, content);
  append_little_endian(bytes, dynamixel_checksum(bytes), 2);
  return bytes;
}

std::optional<DynamixelInstruction> DynamixelReader::next() {
  while (true) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + header_start(buffer_));
    if (buffer_.size() < kPrefixBytes) {
      return std::nullopt;
    }
    const std::size_t length = little_endian(ByteView(buffer_).subspan(5, 2));
    if (length < 3 || length > kLongest) {
      buffer_.erase(buffer_.begin());
      continue;
    }
    const std::size_t size = kPrefixBytes + length;
    if (buffer_.size() < size) {
      return std::nullopt;
    }
    const ByteView packet = ByteView(buffer_).first(size);
    DynamixelInstruction instruction;
    instruction.id = packet[4];
    instruction.code = packet[kPrefixBytes];
    instruction.parameters = unstuffed(packet.subspan(kPrefixBytes + 1, length - 3));
    instruction.is_damaged =
        dynamixel_checksum(packet.first(size - 2)) != little_endian(packet.last(2));
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(size));
    return instruction;
  }
}

}  // namespace nodmap::sim
