// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "drivers/laser3d/sick_scan.hpp"

namespace nodmap::laser3d {

enum class SickUnit : std::uint8_t { kCentimetre = 0, kMillimetre = 1 };

/// The sensor's permanent configuration. Bytes this driver has no use for are kept as they are.
struct SickConfig {
  Bytes bytes;  ///< 34, or 32 with older firmware

  [[nodiscard]] SickMeasuringMode measuring_mode() const { return {bytes[5]}; }
  [[nodiscard]] SickUnit unit() const { return static_cast<SickUnit>(bytes[6]); }
  [[nodiscard]] bool sends_indices() const { return (bytes[4] & 0x02) != 0; }

  [[nodiscard]] bool operator==(const SickConfig&) const = default;
};

/// The configuration in an answer to reading (F4) or to writing (F7, when it was accepted).
[[nodiscard]] std::optional<SickConfig> read_config(const SickTelegram& telegram);

/// The configuration with what this driver decides put in: unit, measuring mode, indices sent.
[[nodiscard]] SickConfig with_measuring(SickConfig config, SickUnit unit, SickMeasuringMode mode);

}  // namespace nodmap::laser3d
