// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "drivers/laser3d/sick/telegram.hpp"
#include "tests/support/hex.hpp"

namespace nodmap::laser3d::test {

using nodmap::test::hex;
using nodmap::test::operator+;

/// Encodes a telegram of the sensor from reply code and data, independently of the driver's code.
inline Bytes sick_frame(const Bytes& reply_and_data, std::uint8_t status = 0x10) {
  Bytes bytes = {0x02, 0x80};
  serial::append_little(bytes, static_cast<std::uint16_t>(reply_and_data.size() + 1));
  bytes = bytes + reply_and_data;
  bytes.push_back(status);
  serial::append_little(bytes, sick_crc(bytes));
  return bytes;
}

/// Words for measured values: 1000, 1001, ... as in the ramp telegrams.
inline Bytes ramp(int count, int first = 1000, int step = 1) {
  Bytes bytes;
  for (int i = 0; i < count; ++i) {
    serial::append_little(bytes, static_cast<std::uint16_t>(first + i * step));
  }
  return bytes;
}

/// The telegram in these bytes; an empty one if there is none.
inline SickTelegram telegram_of(const Bytes& bytes) {
  SickParser parser;
  parser.feed(bytes, {});
  const auto event = parser.next();
  return event ? std::get<SickTelegram>(*event) : SickTelegram{};
}

// Telegrams of the sensor, complete with the checksums that manuals print or that were computed
// independently (see README.md).
inline const Bytes kModeOk = hex("02 80 03 00 A0 00 10 16 0A");
inline const Bytes kWrongPassword = hex("02 80 03 00 A0 01 10 14 0B");
inline const Bytes kVariant180x100 = hex("02 80 07 00 BB 01 B4 00 64 00 10 5B 30");
inline const Bytes kVariant180x050 = hex("02 80 07 00 BB 01 B4 00 32 00 10 03 9D");
inline const Bytes kVariantRefused = hex("02 80 07 00 BB 00 B4 00 64 00 10 7B 20");
inline const Bytes kResetDone = hex("02 80 02 00 91 10 79 30");
inline const Bytes kNotAccepted = hex("02 80 02 00 92 10 7F 33");
inline const Bytes kNoErrors = hex("02 80 02 00 B2 10 3F 13");
inline const Bytes kModeOkFrom1 = hex("02 81 03 00 A0 00 10 36 1A");
inline const Bytes kPowerOn =
    hex("02 80 17 00 90 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 63 5E");
inline const Bytes kType =
    hex("02 80 17 00 BA 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 22 61");
inline const Bytes kConfig =
    hex("02 80 24 00 F4 00 00 70 00 02 06 01 00 00 02 02 00x21 02 00 10 B9 F9");
inline const Bytes kConfigWritten =
    hex("02 80 25 00 F7 01 00 00 70 00 02 06 01 00 00 02 02 00x21 02 00 10 40 78");
inline const Bytes kThreeMm = hex("02 80 0A 00 B0 03 40 E8 03 F7 1F FE 1F 10 A7 69");
inline const Bytes kThreeMmIndexed = hex("02 80 0C 00 B0 03 40 E8 03 F7 1F FE 1F 2A 07 10 2F B4");
inline const Bytes kThreeCm = hex("02 80 0A 00 B0 03 00 01 00 02 00 03 00 10 DC DE");
inline const Bytes kFlat181 = hex("02 80 6E 01 B0 B5 40") + ramp(181, 1000, 0) + hex("10 95 6D");
inline const Bytes kRamp181 = hex("02 80 6E 01 B0 B5 40") + ramp(181) + hex("10 B3 BE");
inline const Bytes kRamp181Indexed =
    hex("02 80 70 01 B0 B5 40") + ramp(181) + hex("2A 07 10 54 C3");
inline const Bytes kFlat361 = hex("02 80 D6 02 B0 69 41") + ramp(361, 1000, 0) + hex("10 55 F1");
inline const Bytes kPartial50 = hex("02 80 6C 01 B0 B4 50") + ramp(180) + hex("10 5B 60");
inline const Bytes kPartial50Marked = hex("02 80 6C 01 B0 B4 70") + ramp(180) + hex("10 DD 43");

}  // namespace nodmap::laser3d::test
