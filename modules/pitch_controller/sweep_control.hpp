// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "modules/pitch_controller/params.hpp"

namespace nodmap::pitch_controller {

using robot::PitchInterval;

/// What PITCH_STATE tells of the head.
struct PitchReading {
  std::int64_t time_us = 0;
  double pitch_rad = 0.0;
  double rate_rad_s = 0.0;
  std::int64_t sweep = 0;  ///< counts the reversals at the ends
  bool is_stalled = false;
};

/// One monotone movement from end to end, or what has been seen of it.
struct MeasuredSweep {
  double duration_s = 0.0;
  PitchInterval span;
  double peak_rate_rad_s = 0.0;  ///< >= 0
  bool is_complete = false;      ///< both its ends were seen as they happened
};

/// Measures the sweeps as they are, not as they were commanded.
class SweepMeter {
 public:
  /// The sweep that ended with this reading, if one did. When time or count steps back, the driver
  /// has started anew, and so does the measurement.
  std::optional<MeasuredSweep> add(const PitchReading& reading);

  /// The last period of the nod: the pitches that the last two sweeps covered together, with the
  /// longest duration and the highest rate of these and of the present one. Empty before two
  /// complete sweeps.
  [[nodiscard]] std::optional<MeasuredSweep> period() const;

  /// How long the present sweep has lasted, seconds.
  [[nodiscard]] double present_sweep_s() const { return present_.duration_s; }

 private:
  void begin(const PitchReading& reading, bool at_its_end);
  void extend(const PitchReading& reading);

  std::optional<PitchReading> newest_;
  std::int64_t began_us_ = 0;
  MeasuredSweep present_;
  std::optional<MeasuredSweep> last_;
  std::optional<MeasuredSweep> before_last_;
};

/// Proportional-integral control of the sweep time (paper, II). The set point itself is fed
/// forward; what is regulated is a factor on it, so that what is learnt of the servo holds at every
/// speed.
///
/// A sweep follows its command with a gain g and a delay of one sweep. With e the relative error,
/// z^2 - (1 - g (p + i)) z - g p = 0; for p = 0.1, i = 0.6 and any g from 0.5 to 1.5 both roots
/// are below 0.73 in size.
class SweepRegulator {
 public:
  explicit SweepRegulator(const RegulatorParams& gains) : gains_(gains) {}

  /// A sweep has ended whose set point was `wanted_s` (> 0) all along, and that took `measured_s`.
  void add(double wanted_s, double measured_s);

  /// The sweep time to be commanded for `wanted_s` to come out, within the limits.
  [[nodiscard]] double command_s(double wanted_s, double fastest_s, double slowest_s);

 private:
  enum class Limit { kNone, kFastest, kSlowest };

  RegulatorParams gains_;
  double error_ = 0.0;  // of the last sweep, relative; negative: it was too slow
  double integral_ = 0.0;
  Limit limit_ = Limit::kNone;  // met by the last command
};

}  // namespace nodmap::pitch_controller
