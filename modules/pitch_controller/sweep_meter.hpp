// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// What PITCH_STATE tells of the head.
struct PitchReading {
  std::int64_t time_us = 0;
  double pitch_rad = 0.0;
  double rate_rad_s = 0.0;
  std::int64_t sweep = 0;  ///< counts the turns at the ends
  bool is_stalled = false;
};

/// One way from end to end, or what has been seen of it.
struct MeasuredSweep {
  double duration_s = 0.0;
  PitchInterval span;
  double peak_rate_rad_s = 0.0;  ///< >= 0
  bool is_whole = false;         ///< both its ends were seen as they happened
};

/// Measures the nod as it is, not as it was wished to be.
class SweepMeter {
 public:
  /// The sweep that ended with this reading, if one did. Time or count that steps back: the driver
  /// started anew, and so does the measurement.
  std::optional<MeasuredSweep> add(const PitchReading& reading);

  /// The period that has been shown last: what the last two sweeps looked at together, with the
  /// longest time and the highest rate of these and of the one under way. Empty before two whole
  /// sweeps.
  [[nodiscard]] std::optional<MeasuredSweep> period() const;

  /// How long the sweep under way has lasted, seconds.
  [[nodiscard]] double under_way_s() const { return current_.duration_s; }

 private:
  void begin(const PitchReading& reading, bool at_its_end);
  void extend(const PitchReading& reading);

  std::optional<PitchReading> newest_;
  std::int64_t began_us_ = 0;
  MeasuredSweep current_;
  std::optional<MeasuredSweep> last_;
  std::optional<MeasuredSweep> before_last_;
};

}  // namespace nodmap::pitch_controller
