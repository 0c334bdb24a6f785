// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::slam6d {

/// The prior of the pitch latency.
struct PitchLatencyParams {
  double sigma_s = 0.002;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("sigma_s", sigma_s, {0.0, 0.1},
             "Standard deviation of the constant delay between the stamps of the pitch and of the "
             "beams, which no driver can measure and which is learned; 0: not learned.");
  }
};

/// How much later than the beams the pitch is stamped. With a latency of one millisecond, a head
/// that moves up at 2 rad/s is 0.11 degrees higher than its pitch says, and one that moves down is
/// as much lower. When the sweeps are registered, the robot seems to nod in the opposite direction.
/// A Kalman filter learns the latency from these changes of the robot's pitch from sweep to sweep.
class PitchLatency {
 public:
  explicit PitchLatency(const PitchLatencyParams& params)
      : variance_(params.sigma_s * params.sigma_s) {}

  /// Learns from one sweep to the next: the robot's pitch rose by `pitch_change_rad` more than the
  /// ground explains, with this variance, while the head's pitch rate changed by
  /// `rate_change_rad_s`.
  void learn(double rate_change_rad_s, double pitch_change_rad, double pitch_change_variance);

  /// The latency, seconds: the true pitch is the reported pitch plus this times its rate.
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  double seconds_ = 0.0;
  double variance_;
};

}  // namespace nodmap::slam6d
