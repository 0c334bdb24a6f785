// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/laser3d/servo/dynamixel.hpp"
#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d::test {

/// A servo with its registers, moving at the profile velocity. It builds its answers without the
/// driver's encoders.
class FakeServo {
 public:
  FakeServo() {
    registers[63] = 0x34;  // errors at which it switches itself off: factory setting
  }

  std::array<std::uint8_t, 150> registers{};
  bool powered = true;
  bool alert = false;
  bool jammed = false;
  int damage_next = 0;  // requests that arrive damaged
  int refuse_next = 0;  // requests that it refuses
  int booted_ms = 0;
  int mode_writes = 0;
  int reboots = 0;
  double position = 2048.0;
  std::optional<std::int32_t> told_position;  // instead of where it is

  void step_ms(int now_ms) {
    const double goal = boost::endian::load_little_s32(&registers[116]);
    const double speed =
        jammed ? 0.0 : boost::endian::load_little_u32(&registers[112]) * 0.229 / 60.0 * 4.096;
    const double moved = std::clamp(goal - position, -speed, speed);  // in this millisecond
    position += moved;
    const auto velocity = static_cast<std::int32_t>(std::lround(moved * 60.0 / 4.096 / 0.229));
    put(128, static_cast<std::uint32_t>(velocity), 4);
    put(120, static_cast<std::uint32_t>((now_ms - booted_ms) % 32'768), 2);
    const auto true_position = static_cast<std::int32_t>(std::lround(position));
    put(132, static_cast<std::uint32_t>(told_position.value_or(true_position)), 4);
  }

  Bytes answer(const Bytes& request) {
    if (!powered) {
      return {};
    }
    if (damage_next > 0) {
      --damage_next;
      return status({}, 0x03);
    }
    if (refuse_next > 0) {
      --refuse_next;
      return status({}, 0x07);
    }
    const std::uint8_t instruction = request[7];
    const std::size_t address =
        request.size() > 10 ? boost::endian::load_little_u16(&request[8]) : 0;
    switch (instruction) {
      case 0x01:
        return status(hex("FC 03 26"));
      case 0x02: {
        const std::size_t count = boost::endian::load_little_u16(&request[10]);
        return status(Bytes(registers.begin() + static_cast<std::ptrdiff_t>(address),
                            registers.begin() + static_cast<std::ptrdiff_t>(address + count)));
      }
      case 0x03:
        mode_writes += address == 11 ? 1 : 0;
        std::copy(request.begin() + 10, request.end() - 2,
                  registers.begin() + static_cast<std::ptrdiff_t>(address));
        return status({});
      case 0x08:
        ++reboots;
        alert = false;
        return status({});
      default:
        return {};
    }
  }

 private:
  Bytes status(const Bytes& parameters, std::uint8_t error = 0x00) const {
    Bytes bytes = hex("FF FF FD 00 01");
    serial::append_little(bytes, static_cast<std::uint16_t>(parameters.size() + 4));
    bytes.push_back(0x55);
    bytes.push_back(error | (alert ? 0x80 : 0x00));
    bytes = bytes + parameters;
    serial::append_little(bytes, dynamixel_crc(bytes));
    return bytes;
  }

  void put(std::size_t at, std::uint32_t value, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      registers[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }
};

}  // namespace nodmap::laser3d::test
