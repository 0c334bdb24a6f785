// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/laser3d/sick_config.hpp"

namespace nodmap::laser3d {

/// Field of view and resolution of a scan.
enum class SickVariant : std::uint8_t { k180x100, k180x050, k100x100, k100x050, k100x025 };

/// What a variant means, in numbers.
struct SickGeometry {
  int field_deg = 0;
  int resolution_cdeg = 0;  ///< hundredths of a degree from beam to beam
  int turns = 0;            ///< of the mirror for one scan; each is shifted by one resolution step

  [[nodiscard]] int num_values() const { return field_deg * 100 / resolution_cdeg + 1; }
};
[[nodiscard]] SickGeometry geometry_of(SickVariant variant);

enum class SickMode : std::uint8_t {
  kInstallation = 0x00,  ///< needs the password
  kDiagnosis = 0x10,
  kStreamAll = 0x24,
  kOnRequest = 0x25,
  kStreamInterlaced = 0x2A,
};

/// Requests to the sensor, as bytes on the line. Addressed to all: one sensor on one line.
namespace sick_command {

[[nodiscard]] Bytes frame(ByteView command_and_parameters);
[[nodiscard]] Bytes set_mode(SickMode mode);
[[nodiscard]] Bytes set_sub_range(int first_value, int last_value);
/// Only 9600, 19200, 38400 and 500000 are possible: anything else asks for 9600.
[[nodiscard]] Bytes set_baud(int baud);
/// Whether the sensor uses its present rate after power-on (false: 9600).
[[nodiscard]] Bytes keep_baud(bool permanent);
[[nodiscard]] Bytes set_variant(SickVariant variant);
[[nodiscard]] Bytes request_scan();
[[nodiscard]] Bytes request_partial_scan();
[[nodiscard]] Bytes request_status();
[[nodiscard]] Bytes request_errors();
[[nodiscard]] Bytes request_type();
[[nodiscard]] Bytes request_config();
[[nodiscard]] Bytes write_config(const SickConfig& config);
[[nodiscard]] Bytes reset();

}  // namespace sick_command
}  // namespace nodmap::laser3d
