// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/servo/dynamixel.hpp"

#include <algorithm>
#include <array>

namespace nodmap::laser3d {
namespace {

using boost::endian::load_little_u16;
using serial::append_little;
using serial::FrameStart;

constexpr std::array<std::uint8_t, 4> kHeader = {0xFF, 0xFF, 0xFD, 0x00};
constexpr std::size_t kIdAt = 4;
constexpr std::size_t kLengthAt = 5;
constexpr std::size_t kInstructionAt = 7;
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kSmallestStatus = kInstructionAt + 2 + kCrcBytes;  // instruction, error
// More than the longest answer that this driver requests, and than any instruction that it sends.
constexpr std::size_t kMaxLength = 128;

constexpr std::uint8_t kPing = 0x01;
constexpr std::uint8_t kRead = 0x02;
constexpr std::uint8_t kWrite = 0x03;
constexpr std::uint8_t kReboot = 0x08;
constexpr std::uint8_t kStatus = 0x55;

// Whether the last three bytes equal the start of a packet.
bool ends_like_a_header(const Bytes& bytes) {
  return bytes.size() >= 3 && std::equal(bytes.end() - 3, bytes.end(), kHeader.begin());
}

// Byte stuffing: a header inside a packet is followed by an additional FD.
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
  append_little(bytes, static_cast<std::uint16_t>(1 + content.size() + kCrcBytes));
  bytes.push_back(instruction);
  serial::append(bytes, content);
  append_little(bytes, dynamixel_crc(bytes));
  return bytes;
}

FrameStart start_of_packet(ByteView bytes, bool /*in_step*/) {
  using Kind = FrameStart::Kind;
  const ByteView front = bytes.first(std::min(bytes.size(), kHeader.size()));
  if (!std::equal(front.begin(), front.end(), kHeader.begin())) {
    return {Kind::kNone};
  }
  if (bytes.size() < kInstructionAt) {
    return {Kind::kPlausible, kInstructionAt};
  }
  const std::size_t length = load_little_u16(&bytes[kLengthAt]);
  if (length < 1 + kCrcBytes || length > kMaxLength) {
    return {Kind::kImplausible};
  }
  return {Kind::kPlausible, kInstructionAt + length};
}

bool checksum_holds(ByteView frame) {
  const std::size_t body = frame.size() - kCrcBytes;
  return dynamixel_crc(frame.first(body)) == load_little_u16(&frame[body]);
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
  append_little(parameters, address);
  append_little(parameters, count);
  return packet(id, kRead, parameters);
}

Bytes write(std::uint8_t id, std::uint16_t address, ByteView values) {
  Bytes parameters;
  append_little(parameters, address);
  serial::append(parameters, values);
  return packet(id, kWrite, parameters);
}

Bytes reboot(std::uint8_t id) {
  return packet(id, kReboot, {});
}

std::size_t num_answer_parameters(ByteView instruction) {
  constexpr std::size_t kCountAt = kInstructionAt + 3;
  constexpr std::size_t kModelAndFirmware = 3;
  switch (instruction[kInstructionAt]) {
    case kPing:
      return kModelAndFirmware;
    case kRead:
      return load_little_u16(&instruction[kCountAt]);
    default:
      return 0;
  }
}

}  // namespace dynamixel

DynamixelParser::DynamixelParser(int baud) : scanner_({start_of_packet, checksum_holds}, baud) {}

std::optional<DynamixelStatus> DynamixelParser::next() {
  while (const std::optional<serial::Frame> frame = scanner_.next()) {
    const ByteView packet = frame->bytes;
    if (packet[kInstructionAt] != kStatus || packet.size() < kSmallestStatus) {
      continue;  // our own echo
    }
    const Bytes content = unstuffed(
        packet.subspan(kInstructionAt + 1, packet.size() - kInstructionAt - 1 - kCrcBytes));
    DynamixelStatus status;
    status.first_byte = frame->first_byte;
    status.id = packet[kIdAt];
    status.error = content.front();
    status.parameters.assign(content.begin() + 1, content.end());
    return status;
  }
  return std::nullopt;
}

}  // namespace nodmap::laser3d
