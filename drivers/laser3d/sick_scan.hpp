// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/laser3d/sick_telegram.hpp"

namespace nodmap::laser3d {

/// Byte 5 of the configuration: how far the sensor measures, and how many of a value's upper bits
/// are flags instead of range.
struct SickMeasuringMode {
  std::uint8_t value = 0x06;

  /// The largest number a range can be, code values included: 8191, 16383 or 32767. Empty for
  /// modes whose values are no ranges.
  [[nodiscard]] std::optional<std::uint16_t> top() const;
  /// Which bits of a value are the range.
  [[nodiscard]] std::uint16_t mask() const;
  /// Whether bit 15 tells of dazzling.
  [[nodiscard]] bool has_dazzle_flag() const { return value == 0x00; }
};

/// What the interlaced stream uses, whatever is configured: 32 m, no flags.
inline constexpr SickMeasuringMode kInterlacedMode{0x0F};

/// Counters of the sensor itself, modulo 256.
struct SickIndices {
  std::uint8_t scan = 0;      ///< turns of the mirror
  std::uint8_t telegram = 0;  ///< telegrams sent
};

/// The measured values of one telegram, in metres, from right to left.
struct SickScan {
  std::int64_t first_byte_us = 0;
  std::vector<float> ranges_m;  ///< +infinity: beyond reach; NaN: no measurement
  double range_max_m = 0.0;     ///< the largest range that can be told in this mode
  std::optional<int> quarter;   ///< of a partial scan: shifted by so many quarters of a degree
  std::optional<SickIndices> indices;
  SickStatusByte status;
  int num_dazzled = 0;
  int num_beyond_reach = 0;
  int num_unmeasured = 0;  ///< codes for weak signals and faults, dazzling not among them
};

/// Empty when the telegram is none of measured values, or the mode's values are no ranges.
[[nodiscard]] std::optional<SickScan> read_scan(const SickTelegram& telegram,
                                                SickMeasuringMode mode);

}  // namespace nodmap::laser3d
