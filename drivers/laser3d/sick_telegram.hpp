// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "drivers/laser3d/frame_buffer.hpp"

namespace nodmap::laser3d {

/// Codes of the telegrams a LMS2xx sends: those of the requests plus 80h.
enum class SickReply : std::uint8_t {
  kPowerOn = 0x90,
  kReset = 0x91,
  kNotAccepted = 0x92,
  kMode = 0xA0,
  kMeasuredValues = 0xB0,
  kStatus = 0xB1,
  kErrors = 0xB2,
  kType = 0xBA,
  kVariant = 0xBB,
  kPermanentBaud = 0xE6,
  kConfig = 0xF4,
  kConfigWritten = 0xF7,
};

/// The status byte that ends every telegram of the LMS2xx.
struct SickStatusByte {
  std::uint8_t value = 0;

  /// 0 ok, 1 info, 2 warning, 3 error, 4 fatal.
  [[nodiscard]] int severity() const { return value & 0x07; }
  [[nodiscard]] bool implausible_values() const { return (value & 0x40) != 0; }
  [[nodiscard]] bool polluted() const { return (value & 0x80) != 0; }
};

/// A whole telegram whose checksum and structure hold.
struct SickTelegram {
  std::int64_t first_byte_us = 0;  ///< when its first byte arrived, clock of the caller
  std::uint8_t address = 0;
  SickReply reply{};
  Bytes data;  ///< between the reply code and the status byte
  SickStatusByte status;
};

struct SickAck {};
struct SickNak {};
using SickEvent = std::variant<SickAck, SickNak, SickTelegram>;

/// Finds telegrams in a stream of bytes that may be cut, mixed with others or damaged.
///
/// A frame with an impossible length, structure or checksum was a false start: the search goes on
/// one byte behind it, so that a whole telegram inside is never lost. Keeps less than one telegram
/// and the bytes of one feed().
class SickParser {
 public:
  struct Counts {
    std::int64_t telegrams = 0;
    std::int64_t checksum_errors = 0;
    std::int64_t implausible = 0;  ///< frames given up for their length or structure
    std::int64_t expired = 0;      ///< frames that were never finished
    std::int64_t skipped_bytes = 0;
  };

  static constexpr std::size_t kMaxTelegramBytes = 814;
  explicit SickParser(int baud = 9600) { buffer_.reset(baud); }

  /// Forgets what was received: the line's rate has changed.
  void reset(int baud);

  /// Takes bytes of which the last was read at `now_us`.
  void feed(ByteView bytes, std::int64_t now_us) { buffer_.feed(bytes, now_us); }

  /// Gives up a frame begun when nothing has come for long (FrameBuffer::kExpiryUs).
  void expire(std::int64_t now_us) { buffer_.expire(now_us); }

  /// The next event in what was fed, or nothing. An ACK or NAK is one bare byte, believed only
  /// where no damage was seen since the last telegram; nobody should wait for one.
  [[nodiscard]] std::optional<SickEvent> next();

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  enum class Verdict : std::uint8_t { kWhole, kIncomplete, kExpired, kImplausible, kBadChecksum };

  [[nodiscard]] Verdict judge(ByteView bytes) const;
  [[nodiscard]] Verdict unfinished(std::size_t size) const;
  [[nodiscard]] SickTelegram take_telegram();
  void skip_byte();

  FrameBuffer buffer_;
  bool in_step_ = true;
  Counts counts_;
};

}  // namespace nodmap::laser3d
