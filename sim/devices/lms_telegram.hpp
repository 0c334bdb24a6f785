// SPDX-License-Identifier: BSD-3-Clause
// The telegrams of a SICK LMS2xx from the sensor's side: requests in, answers out.
// (SICK, Telegrams for Configuring and Operating the LMS2xx, 2006, chapters 3 and 12.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include "common/geometry/time.hpp"
#include "sim/body/rangefinder.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {

/// SICK's checksum of all bytes before it.
[[nodiscard]] std::uint16_t lms_checksum(ByteView bytes);

/// A telegram from the sensor: `body` is the reply code and its data.
[[nodiscard]] Bytes lms_telegram(std::uint8_t address, ByteView body, std::uint8_t status);

/// A request with a valid checksum; `body` is command and parameters.
struct LmsRequest {
  std::uint8_t address = 0;
  Bytes body;
};

/// A request with an invalid checksum; the sensor answers NAK.
struct LmsDamaged {};

/// Finds requests in the bytes from the host.
class LmsRequestReader {
 public:
  void feed(ByteView bytes, time::SteadyTime now);
  [[nodiscard]] std::optional<std::variant<LmsRequest, LmsDamaged>> next();
  void reset() { buffer_.clear(); }

 private:
  Bytes buffer_;
  time::SteadyTime last_{};
};

/// How ranges are encoded: the measuring mode (byte 5 of the configuration) and the unit.
struct LmsFormat {
  std::uint8_t measuring_mode = 0;
  bool millimetres = true;
};

/// Partial scans are always in this mode: 32 m, no flags.
inline constexpr std::uint8_t kLmsPartialMode = 0x0F;

/// Whether the emulated sensor has this measuring mode: ranges, with or without room for flags.
[[nodiscard]] bool is_lms_measuring_mode(std::uint8_t mode);

/// The word for one beam: the range, or a code from the top of the range.
[[nodiscard]] std::uint16_t lms_word(const Echo& echo, const LmsFormat& format);

/// A single mirror revolution as a partial scan, shifted by this many quarter degrees.
struct LmsPartial {
  int quarter = 0;
};

/// The two bytes before the values.
[[nodiscard]] std::uint16_t lms_header(std::size_t count, bool millimetres);
[[nodiscard]] std::uint16_t lms_header(std::size_t count, bool millimetres,
                                       const LmsPartial& partial);

}  // namespace nodmap::sim
