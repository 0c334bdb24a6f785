// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/telegram.hpp"

namespace nodmap::laser3d {
namespace {

using boost::endian::load_little_u16;
using serial::Frame;
using serial::FrameStart;

constexpr std::uint8_t kStx = 0x02;
constexpr std::uint8_t kAck = 0x06;
constexpr std::uint8_t kNak = 0x15;
constexpr std::size_t kLengthAt = 2;
constexpr std::size_t kHeaderBytes = 4;  // STX, address, length
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kMaxLength = SickParser::kMaxTelegramBytes - kHeaderBytes - kCrcBytes;
constexpr std::size_t kMaxValues = 401;

// Whether a telegram with this reply code can have this number of bytes from reply code to status
// byte. Checked because the checksum is weak.
bool is_length_of(std::uint8_t reply, std::size_t length) {
  switch (static_cast<SickReply>(reply)) {
    case SickReply::kReset:
    case SickReply::kNotAccepted:
      return length == 2;
    case SickReply::kMode:
    case SickReply::kPermanentBaud:
      return length == 3;
    case SickReply::kVariant:
      return length == 7;
    case SickReply::kConfig:  // older firmware has 32 bytes of configuration
      return length == 34 || length == 36;
    case SickReply::kConfigWritten:
      return length == 35 || length == 37;
    case SickReply::kMeasuredValues:
      return length >= 4;
    default:
      return reply >= 0x90;
  }
}

// Whether a measured-values telegram of this length can begin with this word.
bool is_values_header(std::uint16_t word, std::size_t length) {
  const std::size_t count = word & 0x03FFU;
  const bool unit_known = (word & 0x8000U) == 0;
  const std::size_t plain = 1 + 2 + 2 * count + 1;
  return unit_known && count <= kMaxValues && (length == plain || length == plain + 2);
}

// Whether the bytes received after a telegram's header are consistent with its length.
bool is_content_plausible(ByteView content, std::size_t length) {
  if (content.empty()) {
    return true;
  }
  if (!is_length_of(content[0], length)) {
    return false;
  }
  return content.size() <= 2 || static_cast<SickReply>(content[0]) != SickReply::kMeasuredValues ||
         is_values_header(load_little_u16(&content[1]), length);
}

FrameStart start_of_telegram(ByteView bytes, bool in_step) {
  using Kind = FrameStart::Kind;
  if (bytes[0] != kStx) {
    const bool is_answer = in_step && (bytes[0] == kAck || bytes[0] == kNak);
    return is_answer ? FrameStart{Kind::kPlausible, 1} : FrameStart{Kind::kNone};
  }
  if (bytes.size() > 1 && (bytes[1] & 0x80) == 0) {  // not the address of a sensor
    return {Kind::kImplausible};
  }
  if (bytes.size() < kHeaderBytes) {
    return {Kind::kPlausible, kHeaderBytes};
  }
  const std::size_t length = load_little_u16(&bytes[kLengthAt]);
  if (length < 2 || length > kMaxLength ||
      !is_content_plausible(bytes.subspan(kHeaderBytes), length)) {
    return {Kind::kImplausible};
  }
  return {Kind::kPlausible, kHeaderBytes + length + kCrcBytes};
}

bool checksum_holds(ByteView frame) {
  if (frame.size() == 1) {  // ACK and NAK have none
    return true;
  }
  const std::size_t body = frame.size() - kCrcBytes;
  return sick_crc(frame.first(body)) == load_little_u16(&frame[body]);
}

SickTelegram telegram_in(const Frame& frame) {
  const ByteView content =
      frame.bytes.subspan(kHeaderBytes, frame.bytes.size() - kHeaderBytes - kCrcBytes);
  SickTelegram telegram;
  telegram.first_byte = frame.first_byte;
  telegram.address = frame.bytes[1];
  telegram.reply = static_cast<SickReply>(content.front());
  telegram.data.assign(content.begin() + 1, content.end() - 1);
  telegram.status = {content.back()};
  return telegram;
}

}  // namespace

std::uint16_t sick_crc(ByteView bytes) {
  constexpr unsigned kPolynomial = 0x8005;
  unsigned crc = 0;
  unsigned previous = 0;
  for (const std::uint8_t byte : bytes) {
    crc = (crc & 0x8000U) != 0 ? ((crc & 0x7FFFU) << 1U) ^ kPolynomial : crc << 1U;
    crc ^= (previous << 8U) | byte;
    previous = byte;
  }
  return static_cast<std::uint16_t>(crc);
}

SickParser::SickParser(int baud) : scanner_({start_of_telegram, checksum_holds}, baud) {}

std::optional<SickEvent> SickParser::next() {
  const std::optional<Frame> frame = scanner_.next();
  if (!frame) {
    return std::nullopt;
  }
  if (frame->bytes.front() == kAck) {
    return SickAck{};
  }
  if (frame->bytes.front() == kNak) {
    return SickNak{};
  }
  ++telegrams_;
  return telegram_in(*frame);
}

}  // namespace nodmap::laser3d
