// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"
#include "modules/pitch_controller/params.hpp"

namespace nodmap::pitch_controller {

using robot::PitchInterval;

/// The state of the head, as in PITCH_STATE.
struct PitchReading {
  time::Timestamp stamp{};
  double pitch_rad = 0.0;
  double rate_rad_s = 0.0;
  std::int64_t sweep = 0;  ///< number of the sweep; increases at each reversal
  bool is_stalled = false;
};

/// A sweep, or the measured part of it.
struct MeasuredSweep {
  double duration_s = 0.0;
  PitchInterval span;
  double peak_rate_rad_s = 0.0;  ///< >= 0
  bool is_complete = false;      ///< both ends were measured
  bool is_upwards = false;       ///< it ended nearer to its upper end

  /// The rate at which the head covers this span in this time, with half a reversal of
  /// `acceleration_rad_s2` at each end.
  [[nodiscard]] double mean_rate_rad_s(double acceleration_rad_s2) const;
};

/// Measures the duration, pitches and rate of the actual sweeps, as opposed to the commanded ones.
class SweepMeter {
 public:
  /// Adds a reading and returns the sweep that it ends, if any. If time or sweep number steps back,
  /// the driver has restarted, and the measurement starts again. Readings whose time alone steps
  /// back, by no more than 60 ms, are left out.
  std::optional<MeasuredSweep> add(const PitchReading& reading);

  /// The last two sweeps, one up and one down, as a single one: the pitches that they covered
  /// together, and the longest duration of a sweep and the highest rate among these two and the
  /// present one. Empty before two complete sweeps.
  [[nodiscard]] std::optional<MeasuredSweep> last_two_sweeps() const;

  /// The present sweep so far.
  [[nodiscard]] const MeasuredSweep& present() const { return present_; }

  /// Whether the last sweep or the present one is not measured from end to end because readings
  /// were more than 60 ms apart.
  [[nodiscard]] bool has_gap() const { return had_gap_ || has_gap_; }

 private:
  void begin(const PitchReading& reading, bool at_its_end);
  void extend(const PitchReading& reading);

  std::optional<PitchReading> newest_;
  time::Timestamp began_{};
  MeasuredSweep present_;
  std::optional<MeasuredSweep> last_;
  std::optional<MeasuredSweep> before_last_;
  bool had_gap_ = false;  // in the last sweep
  bool has_gap_ = false;  // in the present one
};

}  // namespace nodmap::pitch_controller
