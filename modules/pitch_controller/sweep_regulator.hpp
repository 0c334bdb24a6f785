// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "modules/pitch_controller/params.hpp"

namespace nodmap::pitch_controller {

/// Proportional-integral control of the sweep duration (paper, II). The set point is fed forward,
/// and the controller adjusts a factor on it, so that what it learns about the servo applies at
/// every speed.
///
/// A sweep follows its command with a gain g and a delay of one sweep. With e the relative error,
/// z^2 - (1 - g (p + i)) z - g p = 0; for p = 0.1, i = 0.6 and any g from 0.5 to 1.5 both roots
/// are below 0.73 in size.
class SweepRegulator {
 public:
  explicit SweepRegulator(const RegulatorParams& gains) : gains_(gains) {}

  /// Adds a complete sweep that took `measured_s`; its set point was `wanted_s` (> 0) throughout.
  void add(double wanted_s, double measured_s);

  /// The duration to command so that sweeps take `wanted_s`, within the limits.
  [[nodiscard]] double command_s(double wanted_s, double fastest_s, double slowest_s);

 private:
  enum class Limit : std::uint8_t { kNone, kFastest, kSlowest };

  RegulatorParams gains_;
  double error_ = 0.0;  // relative error of the last sweep; negative: it was too slow
  double integral_ = 0.0;
  Limit limit_ = Limit::kNone;  // the limit that the last command reached
};

}  // namespace nodmap::pitch_controller
