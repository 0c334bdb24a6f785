// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/dynamixel.hpp"

#include <algorithm>
#include <array>

namespace nodmap::laser3d {
namespace {

constexpr std::array<std::uint8_t, 4> kHeader = {0xFF, 0xFF, 0xFD, 0x00};
constexpr std::size_t kLengthAt = 5;
constexpr std::size_t kInstructionAt = 7;
constexpr std::size_t kCrcBytes = 2;
// The longest answer this driver asks for, and any instruction it sends, with room to spare.
constexpr std::size_t kMaxLength = 128;

constexpr std::uint8_t kPing = 0x01;
constexpr std::uint8_t kRead = 0x02;
constexpr std::uint8_t kWrite = 0x03;
constexpr std::uint8_t kReboot = 0x08;
constexpr std::uint8_t kStatus = 0x55;

/// Whether the last three bytes look like the start of a packet.
bool ends_like_a_header(const Bytes& bytes) {
  return bytes.size() >= 3 && std::equal(bytes.end() - 3, bytes.end(), kHeader.begin());
}

/// What looks like a header inside a packet is followed by one more FD on the line.
Bytes stuffed(ByteView content) {
  Bytes bytes;
  for (const std::uint8_t byte : content) {
    bytes.push_back(byte);
    if (ends_like_a_header(bytes)) {
      bytes.push_back(0xFD);
    }
  }
  return bytes;
}

Bytes unstuffed(ByteView content) {
  Bytes bytes;
  for (std::size_t i = 0; i < content.size(); ++i) {
    bytes.push_back(content[i]);
    if (ends_like_a_header(bytes) && i + 1 < content.size() && content[i + 1] == 0xFD) {
      ++i;
    }
  }
  return bytes;
}

Bytes packet(std::uint8_t id, std::uint8_t instruction, ByteView parameters) {
  const Bytes content = stuffed(parameters);
  Bytes bytes(kHeader.begin(), kHeader.end());
  bytes.push_back(id);
  append_u16(bytes, static_cast<std::uint16_t>(1 + content.size() + kCrcBytes));
  bytes.push_back(instruction);
  append(bytes, content);
  append_u16(bytes, dynamixel_crc(bytes));
  return bytes;
}

}  // namespace

std::uint16_t dynamixel_crc(ByteView bytes) {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<unsigned>(byte) << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? (crc << 1U) ^ 0x8005U : crc << 1U;
    }
  }
  return static_cast<std::uint16_t>(crc & 0xFFFFU);
}

namespace dynamixel {

Bytes ping(std::uint8_t id) {
  return packet(id, kPing, {});
}

Bytes read(std::uint8_t id, std::uint16_t address, std::uint16_t count) {
  Bytes parameters;
  append_u16(parameters, address);
  append_u16(parameters, count);
  return packet(id, kRead, parameters);
}

Bytes write(std::uint8_t id, std::uint16_t address, ByteView values) {
  Bytes parameters;
  append_u16(parameters, address);
  append(parameters, values);
  return packet(id, kWrite, parameters);
}

Bytes reboot(std::uint8_t id) {
  return packet(id, kReboot, {});
}

}  // namespace dynamixel

std::optional<DynamixelStatus> DynamixelParser::next() {
  while (!buffer_.unread().empty()) {
    const ByteView bytes = buffer_.unread();
    switch (judge(bytes)) {
      case Verdict::kIncomplete:
        return std::nullopt;
      case Verdict::kBadChecksum:
        ++counts_.checksum_errors;
        [[fallthrough]];
      case Verdict::kFalse:
        ++counts_.skipped_bytes;
        buffer_.skip(1);
        continue;
      case Verdict::kWhole:
        break;
    }
    const std::size_t length = read_u16(bytes, kLengthAt);
    const std::size_t size = kInstructionAt + length;
    if (bytes[kInstructionAt] != kStatus || length < 4) {
      buffer_.skip(size);  // our own echo
      continue;
    }
    const Bytes content = unstuffed(bytes.subspan(kInstructionAt + 1, length - 1 - kCrcBytes));
    DynamixelStatus status;
    status.first_byte_us = buffer_.front_arrival_us();
    status.id = bytes[4];
    status.error = content.front();
    status.parameters.assign(content.begin() + 1, content.end());
    buffer_.skip(size);
    ++counts_.answers;
    return status;
  }
  return std::nullopt;
}

DynamixelParser::Verdict DynamixelParser::judge(ByteView bytes) const {
  const auto wait_for = [this](std::size_t size) {
    return buffer_.may_reach(size) ? Verdict::kIncomplete : Verdict::kFalse;
  };
  const std::size_t compared = std::min(bytes.size(), kHeader.size());
  if (!std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(compared),
                  kHeader.begin())) {
    return Verdict::kFalse;
  }
  if (bytes.size() < kInstructionAt) {
    return wait_for(kInstructionAt);
  }
  const std::size_t length = read_u16(bytes, kLengthAt);
  if (length < 1 + kCrcBytes || length > kMaxLength) {
    return Verdict::kFalse;
  }
  const std::size_t size = kInstructionAt + length;
  if (bytes.size() < size || !buffer_.may_reach(size)) {
    return wait_for(size);
  }
  return dynamixel_crc(bytes.first(size - kCrcBytes)) == read_u16(bytes, size - kCrcBytes)
             ? Verdict::kWhole
             : Verdict::kBadChecksum;
}

}  // namespace nodmap::laser3d
