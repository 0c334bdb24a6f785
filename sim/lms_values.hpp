// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/bytes.hpp"
#include "sim/plant.hpp"

namespace nodmap::sim {

/// How readings become numbers: the measuring mode (byte 5 of the configuration) and the unit.
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

/// A turn of the mirror that is sent by itself: the quarter degrees by which it is shifted.
struct LmsPartial {
  int quarter = 0;
};

/// The two bytes before the values.
[[nodiscard]] std::uint16_t lms_header(std::size_t count, bool millimetres);
[[nodiscard]] std::uint16_t lms_header(std::size_t count, bool millimetres,
                                       const LmsPartial& partial);

}  // namespace nodmap::sim
