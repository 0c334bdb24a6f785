// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick_crc.hpp"

namespace nodmap::laser3d {

std::uint16_t sick_crc(ByteView bytes) {
  constexpr unsigned kPolynomial = 0x8005;
  unsigned crc = 0;
  unsigned previous = 0;
  for (const std::uint8_t byte : bytes) {
    crc = (crc & 0x8000U) != 0 ? ((crc & 0x7FFFU) << 1U) ^ kPolynomial : crc << 1U;
    crc ^= (previous << 8U) | byte;
    previous = byte;
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace nodmap::laser3d
