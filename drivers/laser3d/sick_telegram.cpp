// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick_telegram.hpp"

#include "drivers/laser3d/sick_crc.hpp"

namespace nodmap::laser3d {
namespace {

constexpr std::uint8_t kStx = 0x02;
constexpr std::uint8_t kAck = 0x06;
constexpr std::uint8_t kNak = 0x15;
constexpr std::size_t kHeaderBytes = 4;  // STX, address, length
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kMaxLength = SickParser::kMaxTelegramBytes - kHeaderBytes - kCrcBytes;
constexpr std::size_t kMaxValues = 401;

/// Whether this many bytes from reply code to status byte make sense. The checksum is weak, so
/// what is known of a telegram's length is held against it.
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

/// Whether a measured-values telegram of this length can begin with this word.
bool is_values_header(std::uint16_t word, std::size_t length) {
  const std::size_t count = word & 0x03FFU;
  const bool unit_known = (word & 0x8000U) == 0;
  const std::size_t plain = 1 + 2 + 2 * count + 1;
  return unit_known && count <= kMaxValues && (length == plain || length == plain + 2);
}

}  // namespace

void SickParser::reset(int baud) {
  buffer_.reset(baud);
  in_step_ = true;
}

std::optional<SickEvent> SickParser::next() {
  while (!buffer_.unread().empty()) {
    const std::uint8_t byte = buffer_.unread().front();
    if (byte != kStx) {
      if (in_step_ && (byte == kAck || byte == kNak)) {
        buffer_.skip(1);
        if (byte == kAck) {
          return SickAck{};
        }
        return SickNak{};
      }
      skip_byte();
      continue;
    }
    switch (judge(buffer_.unread())) {
      case Verdict::kWhole:
        return take_telegram();
      case Verdict::kIncomplete:
        return std::nullopt;
      case Verdict::kExpired:
        ++counts_.expired;
        break;
      case Verdict::kImplausible:
        ++counts_.implausible;
        break;
      case Verdict::kBadChecksum:
        ++counts_.checksum_errors;
        break;
    }
    skip_byte();
  }
  return std::nullopt;
}

SickParser::Verdict SickParser::unfinished(std::size_t size) const {
  return buffer_.may_reach(size) ? Verdict::kIncomplete : Verdict::kExpired;
}

SickParser::Verdict SickParser::judge(ByteView bytes) const {
  if (bytes.size() > 1 && (bytes[1] & 0x80) == 0) {
    return Verdict::kImplausible;
  }
  if (bytes.size() < kHeaderBytes) {
    return unfinished(kHeaderBytes);
  }
  const std::size_t length = read_u16(bytes, 2);
  if (length < 2 || length > kMaxLength) {
    return Verdict::kImplausible;
  }
  if (bytes.size() > kHeaderBytes && !is_length_of(bytes[kHeaderBytes], length)) {
    return Verdict::kImplausible;
  }
  if (bytes.size() > kHeaderBytes + 2 &&
      static_cast<SickReply>(bytes[kHeaderBytes]) == SickReply::kMeasuredValues &&
      !is_values_header(read_u16(bytes, kHeaderBytes + 1), length)) {
    return Verdict::kImplausible;
  }
  const std::size_t body = kHeaderBytes + length;
  if (bytes.size() < body + kCrcBytes || !buffer_.may_reach(body + kCrcBytes)) {
    return unfinished(body + kCrcBytes);
  }
  return sick_crc(bytes.first(body)) == read_u16(bytes, body) ? Verdict::kWhole
                                                              : Verdict::kBadChecksum;
}

SickTelegram SickParser::take_telegram() {
  const ByteView bytes = buffer_.unread();
  const std::size_t length = read_u16(bytes, 2);
  const ByteView content = bytes.subspan(kHeaderBytes, length);
  SickTelegram telegram;
  telegram.first_byte_us = buffer_.front_arrival_us();
  telegram.address = bytes[1];
  telegram.reply = static_cast<SickReply>(content.front());
  telegram.data.assign(content.begin() + 1, content.end() - 1);
  telegram.status = {content.back()};
  buffer_.skip(kHeaderBytes + length + kCrcBytes);
  in_step_ = true;
  ++counts_.telegrams;
  return telegram;
}

void SickParser::skip_byte() {
  buffer_.skip(1);
  ++counts_.skipped_bytes;
  in_step_ = false;
}

}  // namespace nodmap::laser3d
