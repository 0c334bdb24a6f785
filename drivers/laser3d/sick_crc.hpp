// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "drivers/laser3d/bytes.hpp"

namespace nodmap::laser3d {

/// The checksum of SICK LMS2xx telegrams over everything before it, sent low byte first. It shifts
/// one bit per byte, so it is none of the catalogue's CRC-16. It notices every single wrong byte,
/// but not an error E in one byte with 2E in the next: a reader needs checks of its own besides.
[[nodiscard]] std::uint16_t sick_crc(ByteView bytes);

}  // namespace nodmap::laser3d
