// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::pitch_controller {

/// Proportional-integral control of the sweep time (R11). The wish itself is fed forward; what is
/// regulated is a factor on it, so that what it has learnt of the servo holds for every speed.
///
/// A sweep follows its command with a gain g and a delay of one sweep. With e the relative error,
/// z^2 - (1 - g (p + i)) z - g p = 0; for p = 0.1, i = 0.6 and any g from 0.5 to 1.5 both roots
/// are below 0.73 in size.
class SweepRegulator {
 public:
  SweepRegulator(double p, double i) : p_(p), i_(i) {}

  /// A sweep has ended that was wished to take `wished_s` (> 0) all along, and took `measured_s`.
  void add(double wished_s, double measured_s);

  /// The sweep time to be commanded so that `wished_s` comes out, within the limits.
  [[nodiscard]] double command_s(double wished_s, double fastest_s, double slowest_s);

 private:
  enum class Limit { kNone, kFastest, kSlowest };

  double p_;
  double i_;
  double error_ = 0.0;  // of the last sweep, relative; negative: it was too slow
  double integral_ = 0.0;
  Limit limit_ = Limit::kNone;  // met by the last command
};

}  // namespace nodmap::pitch_controller
