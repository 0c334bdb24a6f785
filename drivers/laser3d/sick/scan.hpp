// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/time.hpp"
#include "drivers/laser3d/sick/telegram.hpp"

namespace nodmap::laser3d {

/// Field of view and resolution of a scan.
enum class SickVariant : std::uint8_t { k180x100, k180x050, k100x100, k100x050, k100x025 };

/// The geometry of a variant.
struct SickGeometry {
  int field_deg = 0;
  int resolution_cdeg = 0;  ///< hundredths of a degree from beam to beam
  int revolutions = 0;      ///< mirror revolutions per scan; each is shifted by one resolution step

  [[nodiscard]] int num_values() const { return field_deg * 100 / resolution_cdeg + 1; }
};
[[nodiscard]] SickGeometry geometry_of(SickVariant variant);

enum class SickUnit : std::uint8_t { kCentimetre = 0, kMillimetre = 1 };

/// Byte 5 of the configuration: the measuring range, and how many of a value's upper bits are
/// flags.
struct SickMeasuringMode {
  std::uint8_t value = 0x06;

  /// The largest value, including special codes: 8191, 16383 or 32767. Empty for modes whose values
  /// are not ranges.
  [[nodiscard]] std::optional<std::uint16_t> top() const;
  /// The bits of a value that contain the range.
  [[nodiscard]] std::uint16_t mask() const;
  /// Whether bit 15 marks a dazzled beam.
  [[nodiscard]] bool has_dazzle_flag() const { return value == 0x00; }

  [[nodiscard]] bool operator==(const SickMeasuringMode&) const = default;
};

// The modes whose values are ranges without flags, named after their range in millimetre mode.
inline constexpr SickMeasuringMode kReach8m{0x02};
inline constexpr SickMeasuringMode kReach16m{0x04};
inline constexpr SickMeasuringMode kReach32m{0x06};
/// The mode that the interlaced stream always uses: 32 m, no flags.
inline constexpr SickMeasuringMode kInterlacedMode{0x0F};

/// Counters of the sensor itself, modulo 256.
struct SickIndices {
  std::uint8_t scan = 0;      ///< mirror revolutions
  std::uint8_t telegram = 0;  ///< telegrams sent
};

/// The measured values of one telegram, in metres, from right to left.
struct SickScan {
  time::SteadyTime first_byte;
  std::vector<float> ranges_m;  ///< +infinity: beyond reach; NaN: no measurement
  double range_max_m = 0.0;     ///< the largest range of this mode
  std::optional<int> quarter;   ///< for a partial scan: its shift in quarters of a degree
  std::optional<SickIndices> indices;
  SickStatusByte status;
  int num_dazzled = 0;
  int num_unmeasured = 0;  ///< codes for weak signals and faults, without dazzled beams
};

/// Reads a telegram of measured values. Empty for other telegrams, and if the mode's values are not
/// ranges.
[[nodiscard]] std::optional<SickScan> read_scan(const SickTelegram& telegram,
                                                SickMeasuringMode mode);

/// The mirror of the LMS2xx always rotates at 75 Hz (Section II of the paper).
inline constexpr time::FineDuration kMirrorPeriod = 13'320us;
/// Time from one beam to the next of the same revolution; they are always one degree apart.
inline constexpr time::FineDuration kMirrorDegree = kMirrorPeriod / 360.0;

/// The beams of one mirror revolution. The laser measures during half of it: 6.66 ms for 180
/// degrees.
struct MirrorRevolution {
  time::SteadyTime first_beam;
  time::SteadyTime last_beam;
  double angle_first_rad = 0.0;  ///< 0 ahead, positive to the left
  double angle_step_rad = 0.0;
  double range_max_m = 0.0;
  std::vector<float> ranges_m;
};

/// Splits a scan into the mirror revolutions in which it was measured. A scan with half a degree of
/// resolution consists of two revolutions, 13.32 ms apart, each with every second beam; on a
/// nodding laser they have different pitches. `sent_at`: when the sensor began to send the scan,
/// which is the end of the (last) half revolution.
[[nodiscard]] std::vector<MirrorRevolution> mirror_revolutions(const SickScan& scan,
                                                               SickVariant variant,
                                                               time::SteadyTime sent_at);

/// The same for an interlaced scan, which is one revolution.
[[nodiscard]] MirrorRevolution interlaced_revolution(const SickScan& scan,
                                                     time::SteadyTime sent_at);

}  // namespace nodmap::laser3d
