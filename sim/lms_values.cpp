// SPDX-License-Identifier: BSD-3-Clause
#include "sim/lms_values.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace {

// How far below the top of the range the codes lie (telegram listing, 10.1).
constexpr int kDazzled = 1;
constexpr int kBeyondReach = 8;

/// The largest number the mode's bits hold.
int top_of(std::uint8_t mode) {
  if (mode <= 0x02) {
    return 0x1FFF;
  }
  return mode <= 0x04 ? 0x3FFF : 0x7FFF;
}

}  // namespace

bool is_lms_measuring_mode(std::uint8_t mode) {
  return mode <= 0x06 || mode == kLmsPartialMode;
}

std::uint16_t lms_word(const Echo& echo, const LmsFormat& format) {
  constexpr int kDazzleFlag = 0x8000;
  const int top = top_of(format.measuring_mode);
  switch (echo.kind) {
    case Echo::Kind::kDazzled:
      return static_cast<std::uint16_t>((top - kDazzled) |
                                        (format.measuring_mode == 0 ? kDazzleFlag : 0));
    case Echo::Kind::kNothing:
      return static_cast<std::uint16_t>(top - kBeyondReach);
    case Echo::Kind::kRange:
      break;
  }
  const double value = std::round(echo.range_m * (format.millimetres ? 1000.0 : 100.0));
  // From the code on, everything is "beyond"; the optics end at 80 m, whatever the bits hold.
  return static_cast<std::uint16_t>(
      std::clamp(value, 0.0, static_cast<double>(top - kBeyondReach)));
}

std::uint16_t lms_header(std::size_t count, bool millimetres) {
  return static_cast<std::uint16_t>(count | (millimetres ? 0x4000U : 0U));
}

std::uint16_t lms_header(std::size_t count, bool millimetres, const LmsPartial& partial) {
  const auto quarter = static_cast<unsigned>(partial.quarter);
  return static_cast<std::uint16_t>(lms_header(count, millimetres) | 0x2000U | quarter << 11U);
}

}  // namespace nodmap::sim
