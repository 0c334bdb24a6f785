// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"
#include "drivers/serial/frame_scanner.hpp"

namespace nodmap::laser3d {

using serial::Bytes;
using serial::ByteView;

/// The checksum of Dynamixel protocol 2.0: CRC-16 with polynomial 8005h, most significant bit
/// first, start 0, over everything before it.
[[nodiscard]] std::uint16_t dynamixel_crc(ByteView bytes);

/// Instructions to a servo (protocol 2.0), as bytes on the line.
namespace dynamixel {

[[nodiscard]] Bytes ping(std::uint8_t id);
[[nodiscard]] Bytes read(std::uint8_t id, std::uint16_t address, std::uint16_t count);
[[nodiscard]] Bytes write(std::uint8_t id, std::uint16_t address, ByteView values);
[[nodiscard]] Bytes reboot(std::uint8_t id);

/// The number of parameters in the answer to an instruction that succeeds.
[[nodiscard]] std::size_t num_answer_parameters(ByteView instruction);

}  // namespace dynamixel

/// A servo's answer.
struct DynamixelStatus {
  time::SteadyTime first_byte;
  std::uint8_t id = 0;
  std::uint8_t error = 0;
  Bytes parameters;

  /// 0 none, 1 result, 2 instruction, 3 checksum, 4 range, 5 length, 6 limit, 7 access.
  [[nodiscard]] int error_code() const { return error & 0x7F; }
  /// Whether there is a hardware error, for which the servo may have switched itself off; register
  /// 70 contains it.
  [[nodiscard]] bool hardware_alert() const { return (error & 0x80) != 0; }
};

/// Finds answers in the bytes on the line. Both directions share the line, and some adapters echo
/// what the host sends; complete packets that are not answers are skipped without being counted.
class DynamixelParser {
 public:
  explicit DynamixelParser(int baud);

  void reset(int baud) { scanner_.reset(baud); }
  void feed(ByteView bytes, time::SteadyTime now) { scanner_.feed(bytes, now); }
  void expire(time::SteadyTime now) { scanner_.expire(now); }
  [[nodiscard]] std::optional<DynamixelStatus> next();
  [[nodiscard]] const serial::FrameScanner::Errors& errors() const { return scanner_.errors(); }

 private:
  serial::FrameScanner scanner_;
};

}  // namespace nodmap::laser3d
