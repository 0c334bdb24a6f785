// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/laser3d/sick/scan.hpp"

namespace nodmap::laser3d {

/// The sensor's permanent configuration. Bytes that this driver does not use are kept unchanged.
struct SickConfig {
  Bytes bytes;  ///< 34, or 32 with older firmware

  [[nodiscard]] SickMeasuringMode measuring_mode() const { return {bytes[5]}; }
  [[nodiscard]] SickUnit unit() const { return static_cast<SickUnit>(bytes[6]); }
  [[nodiscard]] bool sends_indices() const { return (bytes[4] & 0x02) != 0; }

  [[nodiscard]] bool operator==(const SickConfig&) const = default;
};

/// The configuration in an answer to reading (F4) or to writing (F7, when it was accepted).
[[nodiscard]] std::optional<SickConfig> read_config(const SickTelegram& telegram);

/// The configuration with the settings of this driver: unit, measuring mode, transmission of the
/// indices.
[[nodiscard]] SickConfig with_measuring(SickConfig config, SickUnit unit, SickMeasuringMode mode);

enum class SickMode : std::uint8_t {
  kInstallation = 0x00,  ///< needs the password
  kStreamAll = 0x24,
  kOnRequest = 0x25,
  kStreamInterlaced = 0x2A,
};

/// Requests to the sensor, as bytes on the line. They use the broadcast address, because there is
/// one sensor per line.
namespace sick_command {

[[nodiscard]] Bytes frame(ByteView command_and_parameters);
[[nodiscard]] Bytes set_mode(SickMode mode);
/// Only 9600, 19200, 38400 and 500000 are possible; any other value requests 9600.
[[nodiscard]] Bytes set_baud(int baud);
[[nodiscard]] Bytes set_variant(SickVariant variant);
[[nodiscard]] Bytes request_config();
[[nodiscard]] Bytes write_config(const SickConfig& config);

}  // namespace sick_command
}  // namespace nodmap::laser3d
