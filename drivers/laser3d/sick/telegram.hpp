// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include "common/geometry/time.hpp"
#include "drivers/serial/frame_scanner.hpp"

namespace nodmap::laser3d {

using serial::Bytes;
using serial::ByteView;

/// The checksum of SICK LMS2xx telegrams over everything before it, sent low byte first. It shifts
/// one bit per byte, so it is not one of the standard CRC-16s. It detects every single wrong byte,
/// but not an error E in one byte with 2E in the next, so a reader needs further checks.
[[nodiscard]] std::uint16_t sick_crc(ByteView bytes);

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
  /// Whether the sensor calls its measured values implausible.
  [[nodiscard]] bool implausible() const { return (value & 0x40) != 0; }
  [[nodiscard]] bool polluted() const { return (value & 0x80) != 0; }
};

/// A complete telegram with correct checksum and structure.
struct SickTelegram {
  time::SteadyTime first_byte;  ///< when its first byte arrived
  std::uint8_t address = 0;
  SickReply reply{};
  Bytes data;  ///< between the reply code and the status byte
  SickStatusByte status;
};

struct SickAck {};
struct SickNak {};
using SickEvent = std::variant<SickAck, SickNak, SickTelegram>;

/// Finds telegrams in the bytes from the sensor.
class SickParser {
 public:
  static constexpr std::size_t kMaxTelegramBytes = 814;

  explicit SickParser(int baud = 9600);

  /// Forgets all bytes received so far, because the rate of the line has changed.
  void reset(int baud) { scanner_.reset(baud); }

  /// Adds bytes, the last of which was read at `now`.
  void feed(ByteView bytes, time::SteadyTime now) { scanner_.feed(bytes, now); }

  /// Gives up an incomplete telegram when nothing has been received for FrameScanner::kExpiry.
  void expire(time::SteadyTime now) { scanner_.expire(now); }

  /// The next event in the bytes fed so far, if any. An ACK or NAK is a single unframed byte,
  /// accepted only if there was no damage since the last telegram; do not wait for one.
  [[nodiscard]] std::optional<SickEvent> next();

  /// Number of telegrams found.
  [[nodiscard]] std::int64_t telegrams() const { return telegrams_; }
  [[nodiscard]] const serial::FrameScanner::Errors& errors() const { return scanner_.errors(); }

 private:
  serial::FrameScanner scanner_;
  std::int64_t telegrams_ = 0;
};

}  // namespace nodmap::laser3d
