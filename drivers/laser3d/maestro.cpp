// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/maestro.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::laser3d::maestro {
namespace {

constexpr double kPulseUnitUs = 0.25;
constexpr double kSpeedUnitUsPerS = 25.0;  // a quarter of a microsecond in 10 ms
constexpr double kLargest = 0x3FFF;

/// Values travel in bytes of seven bits.
Bytes command(std::uint8_t code, int channel, double value) {
  const auto number = static_cast<unsigned>(std::lround(std::clamp(value, 0.0, kLargest)));
  return {code, static_cast<std::uint8_t>(channel), static_cast<std::uint8_t>(number & 0x7FU),
          static_cast<std::uint8_t>(number >> 7U)};
}

}  // namespace

Bytes set_target(int channel, double pulse_us) {
  return command(0x84, channel, pulse_us / kPulseUnitUs);
}

Bytes set_speed(int channel, double pulse_us_per_s) {
  return command(0x87, channel, std::max(1.0, pulse_us_per_s / kSpeedUnitUsPerS));
}

Bytes set_acceleration(int channel, int value) {
  return command(0x89, channel, value);
}

Bytes get_position(int channel) {
  return {0x90, static_cast<std::uint8_t>(channel)};
}

Bytes get_errors() {
  return {0xA1};
}

Bytes go_home() {
  return {0xA2};
}

Bytes addressed(int device, const Bytes& compact) {
  Bytes bytes = {0xAA, static_cast<std::uint8_t>(device)};
  bytes.push_back(compact.front() & 0x7FU);
  bytes.insert(bytes.end(), compact.begin() + 1, compact.end());
  return bytes;
}

std::uint8_t crc7(ByteView command) {
  constexpr unsigned kPolynomial = 0x91;
  unsigned crc = 0;
  for (const std::uint8_t byte : command) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc = ((crc & 1U) != 0 ? crc ^ kPolynomial : crc) >> 1U;
    }
  }
  return static_cast<std::uint8_t>(crc);
}

double pulse_us_in(ByteView answer) {
  return kPulseUnitUs * read_u16(answer, 0);
}

}  // namespace nodmap::laser3d::maestro
