// SPDX-License-Identifier: BSD-3-Clause
// Packets of the Dynamixel protocol 2.0 from the servo's side (ROBOTIS e-manual, Protocol 2.0).
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {

enum class DynamixelError : std::uint8_t {
  kNone = 0,
  kInstruction = 2,
  kChecksum = 3,
  kRange = 4,
  kLength = 5,
  kLimit = 6,
  kAccess = 7,
};

inline constexpr std::uint8_t kDynamixelBroadcast = 0xFE;

/// CRC-16 with polynomial 8005h, from zero, the highest bit first.
[[nodiscard]] std::uint16_t dynamixel_checksum(ByteView bytes);

/// A status packet. `alert`: the servo has switched itself off.
[[nodiscard]] Bytes dynamixel_status(std::uint8_t id, DynamixelError error, bool alert,
                                     ByteView parameters);

struct DynamixelInstruction {
  std::uint8_t id = 0;
  std::uint8_t code = 0;
  Bytes parameters;
  bool is_damaged = false;  ///< its checksum is wrong
};

/// Finds instructions in the bytes from the bus.
class DynamixelReader {
 public:
  /// After this long without a byte an incomplete packet is given up.
  static constexpr time::Duration kExpiry = 100ms;

  void feed(ByteView bytes, time::SteadyTime now) {
    if (!bytes.empty() && now - std::exchange(last_byte_, now) > kExpiry) {
      buffer_.clear();
    }
    append(buffer_, bytes);
  }
  [[nodiscard]] std::optional<DynamixelInstruction> next();

 private:
  Bytes buffer_;
  time::SteadyTime last_byte_{};
};

}  // namespace nodmap::sim
