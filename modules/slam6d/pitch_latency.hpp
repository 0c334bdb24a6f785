// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::slam6d {

/// How late the pitch may be told, one standard deviation. 0: nothing is learned.
struct PitchLatencyParams {
  double sigma_s = 0.002;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("sigma_s", sigma_s, {0.0, 0.1},
             "How far the stamps of the pitch and of the beams may be apart, a constant that no "
             "driver can see; learned along. 0: not at all.");
  }
};

/// How much later than the beams the pitch is stamped. The head that looks up at 2 rad/s is, after
/// one millisecond, 0.11 degrees higher than its pitch says, the one that looks down as much lower:
/// registered, the robot seems to nod against its head. A Kalman filter over these changes of the
/// robot's pitch from sweep to sweep.
class PitchLatency {
 public:
  explicit PitchLatency(const PitchLatencyParams& params)
      : variance_(params.sigma_s * params.sigma_s) {}

  /// The robot's pitch rose by `pitch_change_rad` (of this variance) more than the ground would
  /// have it, while the rate of the head's pitch changed by `rate_change_rad_s`: what is still to
  /// be added to seconds().
  void learn(double rate_change_rad_s, double pitch_change_rad, double pitch_change_variance);

  /// What is to be added: the true pitch is the told one plus this times its rate.
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  double seconds_ = 0.0;
  double variance_;
};

}  // namespace nodmap::slam6d
