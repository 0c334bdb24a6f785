// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/laser3d/bytes.hpp"

namespace nodmap::laser3d::maestro {

/// Commands to a Pololu Maestro (compact protocol). It sends pulses to a servo and hears nothing
/// from it: the position it tells is the pulse being sent. Answers are two bare bytes.
[[nodiscard]] Bytes set_target(int channel, double pulse_us);
/// Speed of the pulse, microseconds per second; at least the smallest, since 0 is "unlimited".
[[nodiscard]] Bytes set_speed(int channel, double pulse_us_per_s);
[[nodiscard]] Bytes set_acceleration(int channel, int value);
[[nodiscard]] Bytes get_position(int channel);
/// Reading the errors clears them.
[[nodiscard]] Bytes get_errors();
[[nodiscard]] Bytes go_home();

/// The same command in the Pololu protocol, for several devices on one line.
[[nodiscard]] Bytes addressed(int device, const Bytes& compact);
/// The optional checksum over a command.
[[nodiscard]] std::uint8_t crc7(ByteView command);

/// Pulse in an answer to get_position(), microseconds.
[[nodiscard]] double pulse_us_in(ByteView answer);

}  // namespace nodmap::laser3d::maestro
