// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "common/geometry/time.hpp"
#include "drivers/serial/frame_scanner.hpp"

namespace nodmap::laser3d {

using serial::Bytes;
using serial::ByteView;

/// The checksum of SICK LMS2xx telegrams over everything before it, sent low byte first. It shifts
/// one bit per byte, so it is none of the catalogue's CRC-16. It notices every single wrong byte,
/// but not an error E in one byte with 2E in the next: a reader needs checks of its own besides.
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
  [[nodiscard]] bool implausible_values() const { return (value & 0x40) != 0; }
  [[nodiscard]] bool polluted() const { return (value & 0x80) != 0; }
};

/// A whole telegram whose checksum and structure hold.
struct SickTelegram {
  time::SteadyTime first_byte;  ///< when its first byte arrived, clock of the caller
  std::uint8_t address = 0;
  SickReply reply{};
  Bytes data;  ///< between the reply code and the status byte
  SickStatusByte status;
};

struct SickAck {};
struct SickNak {};
using SickEvent = std::variant<SickAck, SickNak, SickTelegram>;

/// Finds telegrams in the bytes from the sensor. Times are microseconds of the caller's clock.
class SickParser {
 public:
  static constexpr std::size_t kMaxTelegramBytes = 814;

  explicit SickParser(int baud = 9600);

  /// Forgets what was received: the line's rate has changed.
  void reset(int baud) { scanner_.reset(baud); }

  /// Takes bytes of which the last was read at `now`.
  void feed(ByteView bytes, time::SteadyTime now) { scanner_.feed(bytes, now); }

  /// Gives up a telegram begun when nothing has come for long (FrameScanner::kExpiryUs).
  void expire(time::SteadyTime now) { scanner_.expire(now); }

  /// The next event in what was fed, or nothing. An ACK or NAK is one bare byte, believed only
  /// where no damage was seen since the last telegram; nobody should wait for one.
  [[nodiscard]] std::optional<SickEvent> next();

  /// Telegrams found.
  [[nodiscard]] std::int64_t telegrams() const { return telegrams_; }
  [[nodiscard]] const serial::FrameScanner::Errors& errors() const { return scanner_.errors(); }

 private:
  serial::FrameScanner scanner_;
  std::int64_t telegrams_ = 0;
};

}  // namespace nodmap::laser3d
